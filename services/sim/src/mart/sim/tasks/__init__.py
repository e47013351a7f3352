"""Find the scene of a task: one file for each task, with the task's name."""

from __future__ import annotations

from importlib import import_module

from mart.protocol.tasks import Task
from mart.sim.scene.scene import Scene


def scene_of(task: Task) -> Scene:
    """Return a new scene, of the class that the file `<task.name>.py` beside this one names as its `SCENE`."""
    scene: Scene = import_module(f"{__name__}.{task.name}").SCENE(task)
    return scene
