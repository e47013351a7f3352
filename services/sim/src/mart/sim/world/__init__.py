"""Step the shared world of a task: arms, controller, state. Pure; see world.py."""

from __future__ import annotations

from mart.sim.world.batch import WorldBatch
from mart.sim.world.last_states import Diverged, LastStates
from mart.sim.world.progress import TaskProgress
from mart.sim.world.world import World

__all__ = ["Diverged", "LastStates", "TaskProgress", "World", "WorldBatch"]
