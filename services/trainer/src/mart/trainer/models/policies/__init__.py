"""Policies as they act: what a checkpoint becomes when it is loaded."""

from mart.trainer.models.policies.load import load_policy
from mart.trainer.models.policies.policy import ACTION_SIZE, Policy

__all__ = ["ACTION_SIZE", "Policy", "load_policy"]
