"""A seat's view of the shared world: states in, pictures out. Needs no display (EGL), and works without a GPU."""

from __future__ import annotations

import hashlib

import mujoco
import numpy as np
from mujoco.egl import GLContext
from OpenGL import GL  # type: ignore[import-untyped]

from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import Model
from mart.protocol.pose import Pose
from mart.protocol.tasks import get_task
from mart.teleop_gateway.input.retarget import azimuth_of_camera_rad
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.quality import FAST, Image, Quality

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_MAX_GEOMS = 2000
_FILE = "model.mjb"
_SHADOW_MAP_PX = 4096


def load_model(message: Model, quality: Quality = FAST) -> mujoco.MjModel:
    """The compiled model that a room sent, to be drawn in this quality.

    Raises Corrupt where its digest is wrong or it cannot be loaded.
    """
    if hashlib.sha256(message.mjb).hexdigest() != message.sha256:
        raise Corrupt(
            f"A model of {len(message.mjb)} bytes was given that does not match its SHA-256: ask again."
        )
    try:
        model = mujoco.MjModel.from_binary_path(_FILE, {_FILE: message.mjb})
    except ValueError as error:
        raise Corrupt(
            f"A model of MuJoCo {message.mujoco_version} was given; MuJoCo {mujoco.__version__} cannot load it: {error}"
        ) from error
    # The model asks for the largest picture that anybody wants; clearing it costs as much as it is large.
    model.vis.global_.offwidth, model.vis.global_.offheight = quality.width_px, quality.view_height_px
    model.vis.quality.offsamples, model.vis.quality.shadowsize = quality.samples, _SHADOW_MAP_PX
    if quality.shadows:
        _cast_shadows(model)
    return model


def _cast_shadows(model: mujoco.MjModel) -> None:
    """Of the first light, the window: two shadows of everything confuse.

    The soft black spots under things stood in for them; the coloured ones under the tools stay, because they show what
    a tool is above.
    """
    model.light_castshadow[:1] = True
    spots = np.isin(model.geom_bodyid, np.flatnonzero(model.body_mocapid >= 0)) & ~model.geom_rgba[:, :3].any(
        axis=1
    )
    model.geom_rgba[spots, 3] = 0.0


def camera_azimuth_rad(message: Model, model: mujoco.MjModel, arm: str) -> float:
    """Where the camera of `arm`'s seat looks, about the z axis of the arm's base frame."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)
    camera = _camera_id(model, arm)
    camera_in_world = Pose.from_matrix(data.cam_xmat[camera].reshape(3, 3), data.cam_xpos[camera])
    base_in_world = get_task(message.task, len(message.arms)).arm(arm).pose_base_in_world
    return azimuth_of_camera_rad(base_in_world.inverse() @ camera_in_world)


class SeatRenderer:
    """Draws one camera. Build, use and close it on one thread: an OpenGL context belongs to a thread."""

    def __init__(self, model: mujoco.MjModel, camera: str, quality: Quality = FAST) -> None:
        self._model = model
        self._data = mujoco.MjData(model)
        self._view = mujoco.MjvCamera()
        self._view.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._view.fixedcamid = _camera_id(model, camera)
        self._options = mujoco.MjvOption()
        self._scene = mujoco.MjvScene(model, maxgeom=_MAX_GEOMS)
        # The floor fills every view, so the sky would only be drawn to be covered: 1 ms of 10 without a GPU.
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = 0
        self._gl = GLContext(quality.width_px, quality.view_height_px)
        self._gl.make_current()
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        _filter_textures_cheaply(self._context)
        self.resize(quality)

    def resize(self, quality: Quality) -> None:
        """Draws pictures of this size from now on."""
        width, height = quality.width_px, quality.view_height_px
        mujoco.mjr_resizeOffscreen(width, height, self._context)
        self._viewport = mujoco.MjrRect(0, 0, width, height)
        self._upside_down = np.empty((height, width, 3), np.uint8)

    def draw(self, integration_state: bytes, tick: int, picture_rgb: Image) -> None:
        """Fills `picture_rgb`, a picture of this quality: the view, and the strip with the tick below it.

        Raises InvalidInput where the state is not one of this model.
        """
        self._set_state(integration_state)
        mujoco.mjv_updateScene(
            self._model, self._data, self._options, None, self._view, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        mujoco.mjr_readPixels(self._upside_down, None, self._viewport, self._context)
        view_height = len(self._upside_down)
        picture_rgb[:view_height] = self._upside_down[::-1]
        tick_code.write(tick, picture_rgb[view_height:])

    def close(self) -> None:
        self._context.free()
        self._gl.free()

    def _set_state(self, integration_state: bytes) -> None:
        expected = 8 * mujoco.mj_stateSize(self._model, _STATE)
        if len(integration_state) != expected:
            raise InvalidInput(
                f"A state of {len(integration_state)} bytes was given; this model's has {expected}."
            )
        numbers = np.frombuffer(integration_state, dtype="<f8").astype(np.float64)
        mujoco.mj_setState(self._model, self._data, numbers, _STATE)
        # No mj_forward: pictures need where things are, not the forces between them.
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)  # what tracking cameras and lights look at
        mujoco.mj_camlight(self._model, self._data)


def _filter_textures_cheaply(context: mujoco.MjrContext) -> None:
    """Takes the nearest mipmap instead of blending two: 2 ms of 10 without a GPU, and at most 6 levels of 255."""
    for texture, kind in zip(context.texture[: context.ntexture], context.textureType, strict=False):
        if kind == mujoco.mjtTexture.mjTEXTURE_2D:
            GL.glBindTexture(GL.GL_TEXTURE_2D, int(texture))
            GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR_MIPMAP_NEAREST)
    GL.glBindTexture(GL.GL_TEXTURE_2D, 0)


def _camera_id(model: mujoco.MjModel, name: str) -> int:
    camera: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, name)
    if camera < 0:
        raise NotFound.named("camera", name, (model.camera(i).name for i in range(model.ncam)))
    return camera
