"""Pictures of a world: states in, pictures out. Needs no display (EGL), and works without a GPU."""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco.egl import GLContext
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput, NotFound

Image = NDArray[np.uint8]

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_LARGEST_PX = 4096
_MAX_GEOMS = 2000


class Renderer:
    """Draws one viewpoint. Build, use and close it on one thread: an OpenGL context belongs to a thread."""

    def __init__(self, model: mujoco.MjModel, viewpoint: str, width_px: int, height_px: int) -> None:
        """Raises NotFound for an unknown viewpoint, InvalidInput for a size that cannot be."""
        self._model = model
        self._data = mujoco.MjData(model)
        self._view = mujoco.MjvCamera()
        self._view.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._view.fixedcamid = _camera_id(model, viewpoint)
        self._scene = mujoco.MjvScene(model, maxgeom=_MAX_GEOMS)
        self._options = mujoco.MjvOption()
        self.width_px, self.height_px = _size(width_px, height_px)
        self._viewport = mujoco.MjrRect(0, 0, width_px, height_px)
        self._gl = GLContext(width_px, height_px)
        self._gl.make_current()
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_resizeOffscreen(width_px, height_px, self._context)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)

    def draw(self, integration_state: bytes) -> Image:
        """sRGB, shape (height, width, 3). Raises InvalidInput where the state is not one of this model."""
        expected = 8 * mujoco.mj_stateSize(self._model, _STATE)
        if len(integration_state) != expected:
            raise InvalidInput(
                f"A state of {len(integration_state)} bytes was given; this model's has {expected}."
            )
        self._gl.make_current()
        mujoco.mj_setState(self._model, self._data, np.frombuffer(integration_state, "<f8"), _STATE)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)  # what tracking cameras and lights look at
        mujoco.mj_camlight(self._model, self._data)
        mujoco.mjv_updateScene(
            self._model, self._data, self._options, None, self._view, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        upside_down = np.empty((self._viewport.height, self._viewport.width, 3), np.uint8)
        mujoco.mjr_readPixels(upside_down, None, self._viewport, self._context)
        return upside_down[::-1].copy()

    def close(self) -> None:
        self._gl.make_current()
        self._context.free()
        self._gl.free()


def _camera_id(model: mujoco.MjModel, name: str) -> int:
    camera: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, name)
    if camera < 0:
        raise NotFound.named("viewpoint", name, (model.camera(i).name for i in range(model.ncam)))
    return camera


def _size(width_px: int, height_px: int) -> tuple[int, int]:
    if not (1 <= width_px <= _LARGEST_PX and 1 <= height_px <= _LARGEST_PX):
        raise InvalidInput(
            f"A picture of {width_px} x {height_px} px was asked for; each side must be from 1 to {_LARGEST_PX} px."
        )
    return width_px, height_px
