"""Draw a seat's picture: the view from its camera, and below it the strip with the tick."""

from __future__ import annotations

import copy
from collections.abc import Callable

import mujoco
import numpy as np

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import Model, State
from mart.protocol.pose import Pose
from mart.protocol.room_task import task_of_model
from mart.protocol.tasks import Ghost, Task
from mart.render import Image, Renderer, load_model, viewpoint_id
from mart.teleop_gateway.input.retarget import azimuth_of_camera_rad
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.quality import FAST, Quality

_SHADOW_MAP_PX = 4096


def load_room_model(message: Model, quality: Quality = FAST) -> mujoco.MjModel:
    """Return the compiled model that a room sent, to be drawn in this quality; raises as `load_plain_model` does."""
    return drawn_model(load_plain_model(message), quality)


def load_plain_model(message: Model) -> mujoco.MjModel:
    """Return the compiled model that a room sent, as it is.

    Raises Corrupt where its digest is wrong or this version of MuJoCo cannot load it.
    """
    return load_model(
        message.mjb, sha256=message.sha256, mujoco_version=message.mujoco_version, source="the room"
    )


def drawn_model(model: mujoco.MjModel, quality: Quality) -> mujoco.MjModel:
    """Return a model as it is drawn in this quality: a copy, where it looks different."""
    model = copy.copy(model) if quality.shadows else model
    model.vis.quality.offsamples, model.vis.quality.shadowsize = quality.samples, _SHADOW_MAP_PX
    if quality.shadows:
        _cast_shadows(model)
    return model


def camera_azimuth_rad(model: mujoco.MjModel, arm: str) -> float:
    """Return where the camera of `arm`'s seat looks, as an angle about the z axis of the arm's base frame."""
    data = _placed(model)
    base = data.body(f"{arm}/base")
    base_in_world = Pose.from_matrix(base.xmat.reshape(3, 3), base.xpos)
    return azimuth_of_camera_rad(base_in_world.inverse() @ _camera(model, data, arm))


def camera_in_world(model: mujoco.MjModel, arm: str) -> Pose:
    """Return where the camera of `arm`'s seat hangs. Raises NotFound where the model has none of that name."""
    return _camera(model, _placed(model), arm)


def _placed(model: mujoco.MjModel) -> mujoco.MjData:
    """Return the world as the model describes it, with everything in its place."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)
    return data


def _camera(model: mujoco.MjModel, data: mujoco.MjData, arm: str) -> Pose:
    camera = viewpoint_id(model, arm)
    return Pose.from_matrix(data.cam_xmat[camera].reshape(3, 3), data.cam_xpos[camera])


def task_of(message: Model) -> Task | None:
    """Return the task of the room that sent this; None where this version does not know it."""
    try:
        return task_of_model(message)
    except (NotFound, InvalidInput):
        return None


def ghosts_for(task: Task | None, arm: str) -> Callable[[State], Ghost | None]:
    """Return what finds what the picture of `arm`'s operator shows beside what is there, from how far the task is.

    Of a task that this version does not know, nothing.
    """
    if task is None:
        return lambda _: None

    def ghost_in(state: State) -> Ghost | None:
        step = task.next_step(arm, {subtask.name for subtask in state.progress.subtasks if subtask.done})
        return step.ghost if step else None

    return ghost_in


class SeatRenderer:
    """Draw one camera with the tick below it. Build, use and close it on one thread."""

    def __init__(self, model: mujoco.MjModel, camera: str, quality: Quality = FAST) -> None:
        """Raise NotFound for an unknown camera, Unavailable where this machine cannot draw."""
        self._renderer = Renderer(model, camera, quality.width_px, quality.view_height_px)

    def resize(self, quality: Quality) -> None:
        """Draw pictures of this quality's size from now on."""
        self._renderer.resize(quality.width_px, quality.view_height_px)

    def draw(
        self, integration_state: bytes, tick: int, picture_rgb: Image, ghost: Ghost | None = None
    ) -> None:
        """Fill `picture_rgb`, shape (height_px, width_px, 3) of the quality: the view, and the tick in the strip below.

        ghost: what else is shown in the view.

        Raises InvalidInput where the state is not one of this model.
        """
        height_px = self._renderer.height_px
        self._renderer.draw(integration_state, picture_rgb[:height_px], ghost)
        tick_code.write(tick, picture_rgb[height_px:])

    def close(self) -> None:
        """Give back what the renderer holds of the graphics card."""
        self._renderer.close()


def _cast_shadows(model: mujoco.MjModel) -> None:
    """Let the first light, the window, cast shadows: two shadows of everything confuse.

    The soft black spots under things stood in for them; the coloured ones under the tools stay, because they show what
    a tool is above.
    """
    model.light_castshadow[:1] = True
    spots = np.isin(model.geom_bodyid, np.flatnonzero(model.body_mocapid >= 0)) & ~model.geom_rgba[:, :3].any(
        axis=1
    )
    model.geom_rgba[spots, 3] = 0.0
