"""Draw one viewpoint of a world from its integration states. Works without a GPU and without a display."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Ghost
from mart.render.compiled_model import viewpoint_id
from mart.render.drop_shadows import DropShadows
from mart.render.ghosts import add_ghost
from mart.render.gl_context import open_context

Image = NDArray[np.uint8]

LARGEST_PX = 4096
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_MAX_GEOMS = 2000
_MOVING, _STANDING = int(mujoco.mjtCatBit.mjCAT_DYNAMIC), int(mujoco.mjtCatBit.mjCAT_STATIC)


class Renderer:
    """Draw one viewpoint of one model, at one size at a time.

    Several may live on one thread. Build, use and close each on the same thread: an OpenGL context belongs to one.
    """

    def __init__(self, model: mujoco.MjModel, viewpoint: str, width_px: int, height_px: int) -> None:
        """Raise NotFound for an unknown viewpoint, InvalidInput for an impossible size, Unavailable without OpenGL."""
        self._model = model
        self._data = mujoco.MjData(model)
        self._shadows = DropShadows(model)
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._camera.fixedcamid = viewpoint_id(model, viewpoint)
        self._options = mujoco.MjvOption()
        self._scene = mujoco.MjvScene(model, maxgeom=_MAX_GEOMS)
        # The floor fills every view of every task, so the sky would only be drawn to be covered: 1 ms of 10.
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = 0
        _check_size(width_px, height_px)
        self._gl, self._context = open_context(model, width_px, height_px)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self.resize(width_px, height_px)

    @property
    def width_px(self) -> int:
        """The width of the pictures."""
        return self._viewport.width

    @property
    def height_px(self) -> int:
        """The height of the pictures."""
        return self._viewport.height

    def resize(self, width_px: int, height_px: int) -> None:
        """Draw pictures of this size from now on; raises InvalidInput for one that cannot be."""
        _check_size(width_px, height_px)
        self._gl.make_current()
        mujoco.mjr_resizeOffscreen(width_px, height_px, self._context)
        self._viewport = mujoco.MjrRect(0, 0, width_px, height_px)
        self._upside_down = np.empty((height_px, width_px, 3), np.uint8)

    def draw(self, integration_state: bytes, out: Image | None = None, ghost: Ghost | None = None) -> Image:
        """Return the picture of this state, with `ghost` in it: sRGB, uint8, shape (height, width, 3), top row first.

        `out`, of that shape, is filled and returned where it is given. The state is MuJoCo's mjSTATE_INTEGRATION as
        little-endian float64. Raises InvalidInput where it is not one of this model.
        """
        self._set_state(integration_state)
        self._gl.make_current()  # another renderer of this thread may have drawn since
        self._fill_scene()
        self._shadows.add_plumb_lines(self._scene, self._data)
        if ghost is not None:
            add_ghost(self._scene, self._model, ghost)
        self._read(self._upside_down, None)
        if out is None:
            return self._upside_down[::-1].copy()
        out[:] = self._upside_down[::-1]
        return out

    def draw_depth(self, integration_state: bytes) -> NDArray[np.float32]:
        """Return how far along the camera's axis what each pixel shows is: metres, float32, shape (height, width).

        Top row first; where nothing is, the farthest that the model draws. Marks are not part of it. Raises as `draw`.
        """
        self._set_state(integration_state)
        self._gl.make_current()
        self._fill_scene()
        drawn = np.empty((self.height_px, self.width_px), np.float32)
        self._context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR  # float32 is finest near 0
        self._read(None, drawn)
        nearest_m = self._model.vis.map.znear * self._model.stat.extent
        farthest_m = self._model.vis.map.zfar * self._model.stat.extent
        share = nearest_m / farthest_m
        depth_m = nearest_m / (share + drawn * (1.0 - share))
        return depth_m[::-1].astype(np.float32)

    def draw_segmentation(self, integration_state: bytes) -> NDArray[np.int32]:
        """Return which body of the model each pixel shows: int32, shape (height, width), top row first.

        0 is what stands (the world), -1 where nothing is. Marks are not part of it. Raises as `draw`.
        """
        self._set_state(integration_state)
        self._gl.make_current()
        self._fill_scene()
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        self._scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        try:
            self._read(self._upside_down, None)
        finally:
            self._scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 0
            self._scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 0
        # An id is a colour, red the lowest byte: 0 is nothing, else one more than the shape's place in the scene.
        numbers = self._upside_down[::-1].astype(np.int32) @ np.array([1, 1 << 8, 1 << 16], np.int32)
        bodies = np.full(self._scene.ngeom + 1, -1, np.int32)
        for shape in self._scene.geoms[: self._scene.ngeom]:
            if shape.segid >= 0 and shape.objtype == mujoco.mjtObj.mjOBJ_GEOM:
                bodies[shape.segid + 1] = self._model.geom_bodyid[shape.objid]
        return bodies[numbers]

    def _read(self, rgb: Image | None, depth: NDArray[np.float32] | None) -> None:
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        mujoco.mjr_readPixels(rgb, depth, self._viewport, self._context)

    def _fill_scene(self) -> None:
        """Put what moves before what stands: what is drawn first spares what it hides, 3 to 6 % of software drawing."""
        model, data, scene, nobody_pulls = self._model, self._data, self._scene, mujoco.MjvPerturb()
        mujoco.mjv_updateScene(model, data, self._options, nobody_pulls, self._camera, _MOVING, scene)
        mujoco.mjv_addGeoms(model, data, self._options, nobody_pulls, _STANDING, scene)

    def close(self) -> None:
        """Give back what the renderer holds of the graphics card; it cannot draw any more."""
        self._gl.make_current()
        self._context.free()
        self._gl.free()

    def _set_state(self, integration_state: bytes) -> None:
        expected = 8 * mujoco.mj_stateSize(self._model, _STATE)
        if len(integration_state) != expected:
            raise InvalidInput(
                f"A state of {len(integration_state)} bytes was given; this model's has {expected}."
            )
        numbers = np.frombuffer(integration_state, "<f8").astype(np.float64)
        mujoco.mj_setState(self._model, self._data, numbers, _STATE)
        # No mj_forward: pictures need where things are, not the forces between them.
        mujoco.mj_kinematics(self._model, self._data)
        self._shadows.lift(self._data)
        mujoco.mj_comPos(self._model, self._data)  # what tracking cameras and lights look at
        mujoco.mj_camlight(self._model, self._data)


def _check_size(width_px: int, height_px: int) -> None:
    if not (1 <= width_px <= LARGEST_PX and 1 <= height_px <= LARGEST_PX):
        raise InvalidInput(
            f"A picture of {width_px} x {height_px} px was asked for; each side must be from 1 to {LARGEST_PX} px."
        )
