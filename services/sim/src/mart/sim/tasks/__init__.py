"""Scenes: geometry, resets, observations and success. One file for each task, found by the task's name."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from mart.protocol.tasks import Task

if TYPE_CHECKING:  # scenes are built from parts of mart.sim.world, which asks here for scenes
    from mart.sim.tasks.scene import Scene


def scene_of(task: Task) -> Scene:
    """A new one, of the class that the file `<task.name>.py` beside this one names as its `SCENE`."""
    scene: Scene = import_module(f"{__name__}.{task.name}").SCENE(task)
    return scene
