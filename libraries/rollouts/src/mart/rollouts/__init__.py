"""Step many worlds of a task over the bus: what trainings and evaluations have instead of a simulator."""

from mart.rollouts.client import RolloutClient

__all__ = ["RolloutClient"]
