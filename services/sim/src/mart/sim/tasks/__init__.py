"""Find the scene of a task: one file for each task, with the task's name; or what its task file says."""

from __future__ import annotations

from importlib import import_module

from mart.protocol.tasks import Task
from mart.sim.scene.scene import Scene
from mart.sim.tasks.own_scene import OwnScene


def scene_of(task: Task) -> Scene:
    """Return a new scene, of the class that the file `<task.name>.py` beside this one names as its `SCENE`.

    Of somebody's own task it is the one that the task file describes.
    """
    if task.file is not None:
        return OwnScene(task)
    scene: Scene = import_module(f"{__name__}.{task.name}").SCENE(task)
    return scene
