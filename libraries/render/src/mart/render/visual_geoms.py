"""Tell viewers of other projects what a model looks like and where its bodies are: shapes with colours, and poses.

Kinematics alone, so nothing here needs a graphics card or a window.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput
from mart.render.moving_bodies import moving_bodies
from mart.render.scene_export import seen_geoms

Numbers = NDArray[np.float64]

WORLD = "world"
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_COLOR_ROLE = int(mujoco.mjtTextureRole.mjTEXROLE_RGB)
_Type = mujoco.mjtGeom
_KINDS = {
    _Type.mjGEOM_BOX: "box",
    _Type.mjGEOM_SPHERE: "ellipsoid",
    _Type.mjGEOM_ELLIPSOID: "ellipsoid",
    _Type.mjGEOM_CYLINDER: "cylinder",
    _Type.mjGEOM_CAPSULE: "capsule",
    _Type.mjGEOM_MESH: "mesh",
    _Type.mjGEOM_PLANE: "plane",
}


@dataclass(frozen=True)
class VisualGeom:
    """Describe one shape that is seen, in the frame of the body it is fixed to.

    body: a name of `BodyFrames.names`, or "world" for what does not move.
    kind: box, ellipsoid, cylinder (both along z), capsule (along z), plane (facing z) or mesh.
    half_size_m: as MuJoCo has it: half lengths of a box and a plane, radii of an ellipsoid; of a cylinder and a capsule
    radius, radius and half the length of the straight part. Zeros for a mesh.
    rgba: 0 … 1; what has a texture is of that one's mean colour.
    vertices_m: float64[n, 3] and triangles: int64[m, 3], of a mesh alone.
    """

    name: str
    body: str
    kind: str
    half_size_m: Numbers
    position_m: Numbers
    quaternion_wxyz: Numbers
    rgba: Numbers
    vertices_m: Numbers
    triangles: NDArray[np.int64]


class BodyFrames:
    """Work out where the bodies of one model are in a state. Not for two threads at once.

    names: of the bodies that move and are seen, in ascending order of their ids.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        self._bodies = np.array(moving_bodies(model), dtype=int)
        self._size = mujoco.mj_stateSize(model, _STATE)
        self.names = tuple(model.body(body).name for body in self._bodies)

    def poses(self, integration_state: bytes) -> tuple[Numbers, Numbers]:
        """Return positions in the world, float64[bodies, 3] in metres, and quaternions wxyz, float64[bodies, 4].

        Raises InvalidInput for a state that is not one of this model, or is not finite.
        """
        state = np.frombuffer(integration_state, "<f8") if len(integration_state) % 8 == 0 else np.empty(0)
        if state.size != self._size or not np.isfinite(state).all():
            raise InvalidInput(
                f"A state of {len(integration_state)} bytes was given; this model's has {8 * self._size}, all finite."
            )
        mujoco.mj_setState(self._model, self._data, state, _STATE)
        mujoco.mj_kinematics(self._model, self._data)
        return self._data.xpos[self._bodies].copy(), self._data.xquat[self._bodies].copy()

    def geoms(self) -> Iterator[VisualGeom]:
        """Iterate over what is seen of the model; kinds that no viewer knows are passed by."""
        model = self._model
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        for seen in seen_geoms(model, data):
            if int(seen.type) in _KINDS:
                yield self._geom(data, int(seen.objid), seen)

    def cameras(self) -> Iterator[VisualCamera]:
        """Iterate over the cameras that stand still."""
        model, data = self._model, mujoco.MjData(self._model)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        for camera in range(model.ncam):
            if model.cam_bodyid[camera] == 0:
                # MuJoCo's cameras look along -z with y up; those of computer vision along z with y down.
                optical = data.cam_xmat[camera].reshape(3, 3) @ np.diag([1.0, -1.0, -1.0])
                yield VisualCamera(
                    model.camera(camera).name,
                    data.cam_xpos[camera].copy(),
                    _quaternion(optical.ravel()),
                    float(model.cam_fovy[camera]),
                )

    def _geom(self, data: mujoco.MjData, geom: int, seen: mujoco.MjvGeom) -> VisualGeom:
        model = self._model
        body = int(model.geom_bodyid[geom])
        moves = body in self._bodies
        is_mesh = int(seen.type) == _Type.mjGEOM_MESH
        vertices, triangles = self._mesh(int(seen.dataid) // 2) if is_mesh else _NO_MESH
        return VisualGeom(
            name=model.geom(geom).name or f"geom{geom}",
            body=model.body(body).name if moves else WORLD,
            kind=_KINDS[int(seen.type)],
            half_size_m=np.zeros(3) if is_mesh else np.array(seen.size, dtype=np.float64),
            position_m=(model.geom_pos if moves else data.geom_xpos)[geom].copy(),
            quaternion_wxyz=model.geom_quat[geom].copy() if moves else _quaternion(data.geom_xmat[geom]),
            rgba=np.array(seen.rgba, dtype=np.float64) * self._texture_rgba(int(seen.matid)),
            vertices_m=vertices,
            triangles=triangles,
        )

    def _texture_rgba(self, material: int) -> Numbers:
        """Return the mean colour of a material's flat texture, white where it has none."""
        model, white = self._model, np.ones(4)
        texture = int(model.mat_texid[material, _COLOR_ROLE]) if material >= 0 else -1
        if texture < 0:
            return white
        channels, start = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
        count = int(model.tex_height[texture]) * int(model.tex_width[texture])
        pixels = np.asarray(model.tex_data[start : start + count * channels]).reshape(count, channels)
        white[: min(channels, 3)] = pixels.mean(axis=0)[:3] / 255
        return white

    def _mesh(self, mesh: int) -> tuple[Numbers, NDArray[np.int64]]:
        model = self._model
        start, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        first, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        return (
            model.mesh_vert[start : start + count].astype(np.float64),
            model.mesh_face[first : first + faces].astype(np.int64),
        )


@dataclass(frozen=True)
class VisualCamera:
    """Describe a camera that stands still: where it is in the world, looking along its z with y down (as in OpenCV)."""

    name: str
    position_m: Numbers
    quaternion_wxyz: Numbers
    fov_y_deg: float


_NO_MESH = (np.zeros((0, 3)), np.zeros((0, 3), np.int64))


def _quaternion(matrix: Numbers) -> Numbers:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(matrix))
    return quaternion
