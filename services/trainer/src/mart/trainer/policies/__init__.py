"""Policies as they act: what a checkpoint becomes when it is loaded."""

from mart.trainer.policies.load import load_policy
from mart.trainer.policies.policy import ACTION_SIZE, Policy

__all__ = ["ACTION_SIZE", "Policy", "load_policy"]
