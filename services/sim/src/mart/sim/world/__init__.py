"""The shared world: room, arms, controller, state. Pure; see world.py."""

from __future__ import annotations

from mart.sim.world.progress import Progress
from mart.sim.world.world import ACTION_SIZE, Diverged, World

__all__ = ["ACTION_SIZE", "Diverged", "Progress", "World"]
