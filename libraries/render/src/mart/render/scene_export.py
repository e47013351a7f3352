"""Write what a page needs to draw a compiled model: docs/protocol.md, "Scene". Pure: a model in, bytes out."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Subtask, Task
from mart.render import unit_shapes
from mart.render.decor import add_column
from mart.render.drop_shadows import DropShadows, PlumbLine
from mart.render.ghosts import add_ghost
from mart.render.moving_bodies import moving_bodies
from mart.render.scene_buffers import MeshEntry, SceneBuffer
from mart.render.unit_shapes import Corners, Numbers

_MAX_GEOMS = 2000
_SHARP = 0.8  # cosine between a corner's normal and its face's, below which MuJoCo takes the face's
_COLOR_ROLE = int(mujoco.mjtTextureRole.mjTEXROLE_RGB)
_Type = mujoco.mjtGeom


@dataclass(frozen=True)
class PageScene:
    """Hold a scene as it is served, and its SHA-256 in hexadecimal."""

    data: bytes
    sha256: str


def export_scene(model: mujoco.MjModel, task: Task | None = None) -> PageScene:
    """Return the scene of a model, with the ghosts of its task where it is known.

    Raises InvalidInput, in a sentence, for what pages cannot draw.
    """
    data = _SceneExport(model).written(task.subtasks if task else ())
    return PageScene(data, hashlib.sha256(data).hexdigest())


class _SceneExport:
    def __init__(self, model: mujoco.MjModel) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        mujoco.mj_kinematics(model, self._data)
        mujoco.mj_comPos(model, self._data)
        mujoco.mj_camlight(model, self._data)
        self._bodies = moving_bodies(model)
        self._buffer = SceneBuffer()
        self._meshes: dict[tuple[float, ...], int] = {}
        self._entries: list[MeshEntry] = []
        self._textures: dict[int, int] = {}
        self._pictures: list[dict[str, Any]] = []

    def written(self, subtasks: Sequence[Subtask]) -> bytes:
        model = self._model
        geoms = [self._geom(seen) for seen in seen_geoms(model, self._data)]
        extent_m = float(model.stat.extent)
        description = {
            "bodies": [model.body(body).name for body in self._bodies],
            "cameras": [self._camera(camera) for camera in range(model.ncam)],
            "far_m": float(model.vis.map.zfar) * extent_m,
            "geoms": geoms,
            "ghosts": [self._ghost(subtasks, step) for step in range(len(subtasks)) if subtasks[step].ghost],
            "headlight": _headlight(model),
            "lights": [self._light(light) for light in np.flatnonzero(model.light_active).tolist()],
            "meshes": [entry.as_json() for entry in self._entries],
            "near_m": float(model.vis.map.znear) * extent_m,
            "plumb_lines": [self._plumb_line(line) for line in DropShadows(model).plumb_lines()],
            "textures": self._pictures,
        }
        return self._buffer.joined(description)

    def _geom(self, seen: mujoco.MjvGeom) -> dict[str, Any]:
        geom = int(seen.objid)
        body = int(self._model.geom_bodyid[geom])
        moves = body in self._bodies
        matrix = self._data.geom_xmat[geom]
        position = self._model.geom_pos[geom] if moves else self._data.geom_xpos[geom]
        quaternion = self._model.geom_quat[geom] if moves else _quaternion(matrix)
        return {
            "body": self._bodies.index(body) if moves else -1,
            **self._seen(seen, position, quaternion),
            **self._texture_of(seen),
        }

    def _seen(self, seen: mujoco.MjvGeom, position_m: Numbers, quaternion: Numbers) -> dict[str, Any]:
        mesh, scale = self._shape(seen)
        return {
            "emission": float(seen.emission),
            "mesh": mesh,
            "plane": seen.type == _Type.mjGEOM_PLANE,
            "position_m": _listed(position_m),
            "quaternion": _listed(quaternion),
            "rgba": _listed(seen.rgba),
            "scale": _listed(scale),
            "shininess": float(seen.shininess) * 128.0,
            "specular": float(seen.specular),
        }

    def _ghost(self, subtasks: Sequence[Subtask], step: int) -> dict[str, Any]:
        """Return what is shown until a subtask is done, and by arm after which others: before, it is not its step."""
        subtask = subtasks[step]
        scene = mujoco.MjvScene(self._model, maxgeom=_MAX_GEOMS)
        assert subtask.ghost is not None
        add_ghost(scene, self._model, subtask.ghost)
        return {
            "after": {
                arm: [before.name for before in subtasks[:step] if arm in before.to_do]
                for arm in subtask.to_do
            },
            "geoms": self._decor(scene),
            "subtask": subtask.name,
        }

    def _plumb_line(self, line: PlumbLine) -> dict[str, Any]:
        """Return a line, a metre of it, and by which bodies and where on them it hangs."""
        model = self._model
        scene = mujoco.MjvScene(model, maxgeom=_MAX_GEOMS)
        add_column(scene, (0.0, 0.0, 0.0), 1.0, line.radius_m, line.rgba)
        return {
            "body": self._bodies.index(int(model.site_bodyid[line.site])),
            "foot_body": self._bodies.index(int(model.geom_bodyid[line.foot_geom])),
            "foot_m": _listed(model.geom_pos[line.foot_geom]),
            "geom": self._decor(scene)[0],
            "position_m": _listed(model.site_pos[line.site]),
        }

    def _decor(self, scene: mujoco.MjvScene) -> list[dict[str, Any]]:
        """Return the shapes of a scene that are no geoms of the model."""
        return [
            {"body": -1, **self._seen(one, one.pos, _quaternion(np.ravel(one.mat).astype(np.float64)))}
            for one in scene.geoms[: scene.ngeom]
        ]

    def _shape(self, seen: mujoco.MjvGeom) -> tuple[int, Numbers]:
        """Return the index of a geom's mesh, and by what it is stretched."""
        kind, size = int(seen.type), np.array(seen.size, dtype=np.float64)
        quality = self._model.vis.quality
        slices, stacks = int(quality.numslices), int(quality.numstacks)
        unit = np.ones(3)
        match kind:
            case _Type.mjGEOM_MESH:
                return self._mesh(
                    (kind, seen.dataid // 2), lambda: self._mesh_corners(seen.dataid // 2)
                ), unit
            case _Type.mjGEOM_BOX:
                return self._mesh((kind,), lambda: unit_shapes.box(int(quality.numquads))), size
            case _Type.mjGEOM_SPHERE | _Type.mjGEOM_ELLIPSOID:
                return self._mesh((_Type.mjGEOM_SPHERE,), lambda: unit_shapes.sphere(slices, stacks)), size
            case _Type.mjGEOM_CYLINDER:
                return self._mesh((kind,), lambda: unit_shapes.cylinder(slices, stacks)), size
            case _Type.mjGEOM_CAPSULE:
                radius_m, _, half_m = [round(length, 6) for length in size.tolist()]
                made: tuple[float, ...] = (kind, radius_m, half_m)
                return self._mesh(made, lambda: unit_shapes.capsule(slices, stacks, radius_m, half_m)), unit
            case _Type.mjGEOM_PLANE if size[:2].all():
                half_x, half_y, spacing = self._model.geom_size[seen.objid].tolist()
                made = (kind, half_x, half_y, spacing)
                return self._mesh(made, lambda: unit_shapes.plane(half_x, half_y, spacing)), unit
        raise InvalidInput(
            f"This room cannot be drawn in a page: {self._name(seen)} is of a kind that pages do not know "
            "(boxes, spheres, capsules, cylinders, ellipsoids, meshes and finite planes are known)."
        )

    def _mesh(self, made: tuple[float, ...], corners: Callable[[], Corners]) -> int:
        if made not in self._meshes:
            self._meshes[made] = len(self._entries)
            self._entries.append(self._buffer.add_mesh(corners()))
        return self._meshes[made]

    def _mesh_corners(self, mesh: int) -> Corners:
        """Return a compiled mesh's corners; one whose normal is far from its face's takes the face's."""
        model = self._model
        faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
        vertices = model.mesh_vert[model.mesh_face[faces] + model.mesh_vertadr[mesh]].astype(np.float64)
        normals = model.mesh_normal[model.mesh_facenormal[faces] + model.mesh_normaladr[mesh]]
        flat = np.cross(vertices[:, 1] - vertices[:, 0], vertices[:, 2] - vertices[:, 0])
        flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-12)
        is_sharp = (normals * flat[:, np.newaxis]).sum(axis=2, keepdims=True) < _SHARP
        chosen = np.where(is_sharp, flat[:, np.newaxis], normals)
        return Corners(vertices.reshape(-1, 3), chosen.reshape(-1, 3))

    def _texture_of(self, seen: mujoco.MjvGeom) -> dict[str, Any]:
        """Return a geom's texture and how it lies: u = x * scale_x - 0.5, v = -y * scale_y - 0.5 of the mesh."""
        model, material = self._model, int(seen.matid)
        texture = int(model.mat_texid[material, _COLOR_ROLE]) if material >= 0 else -1
        if texture < 0:
            return {}
        if seen.texcoord or model.tex_type[texture] != mujoco.mjtTexture.mjTEXTURE_2D:
            raise InvalidInput(
                f"This room cannot be drawn in a page: {self._name(seen)} has a texture that is laid by "
                "coordinates or around a cube; pages know flat ones."
            )
        scale = 0.5 * np.array(model.mat_texrepeat[material], dtype=np.float64)
        size = np.where(np.array(seen.size[:2]) > 0, seen.size[:2], 1.0)
        if seen.dataid >= 0:  # its vertices are in metres
            scale /= size
        if model.mat_texuniform[material]:
            scale *= size
        return {"texture": self._texture(texture), "texture_scale": _listed(scale)}

    def _texture(self, texture: int) -> int:
        if texture not in self._textures:
            model = self._model
            shape = [int(n[texture]) for n in (model.tex_height, model.tex_width, model.tex_nchannel)]
            start = int(model.tex_adr[texture])
            pixels = np.asarray(model.tex_data[start : start + int(np.prod(shape))], dtype=np.uint8)
            self._textures[texture] = len(self._pictures)
            self._pictures.append(self._buffer.add_texture(pixels.reshape(shape)))
        return self._textures[texture]

    def _camera(self, camera: int) -> dict[str, Any]:
        model = self._model
        name = model.camera(camera).name
        if model.cam_mode[camera] != mujoco.mjtCamLight.mjCAMLIGHT_FIXED or model.cam_bodyid[camera]:
            raise InvalidInput(f"This room cannot be drawn in a page: the camera {name!r} moves.")
        return {
            "fov_y_deg": float(model.cam_fovy[camera]),
            "name": name,
            "position_m": _listed(self._data.cam_xpos[camera]),
            "quaternion": _listed(_quaternion(self._data.cam_xmat[camera])),
        }

    def _light(self, light: int) -> dict[str, Any]:
        model = self._model
        is_directional = model.light_type[light] == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        if not is_directional or model.light_bodyid[light]:
            raise InvalidInput(
                "This room cannot be drawn in a page: one of its lights is a lamp or moves; pages know fixed light "
                "from one direction."
            )
        return {
            "ambient": _listed(model.light_ambient[light]),
            "diffuse": _listed(model.light_diffuse[light]),
            "direction": _listed(self._data.light_xdir[light]),
            "specular": _listed(model.light_specular[light]),
        }

    def _name(self, seen: mujoco.MjvGeom) -> str:
        return f"the geom {self._model.geom(seen.objid).name!r}"


def seen_geoms(model: mujoco.MjModel, data: mujoco.MjData) -> list[mujoco.MjvGeom]:
    """Return what MuJoCo draws of a model, colours and sizes as it draws them."""
    scene = mujoco.MjvScene(model, maxgeom=_MAX_GEOMS)
    everything = mujoco.mjtCatBit.mjCAT_ALL
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), everything, scene)
    seen = scene.geoms[: scene.ngeom]
    if any(geom.objtype != mujoco.mjtObj.mjOBJ_GEOM for geom in seen):
        raise InvalidInput(
            "This room cannot be drawn in a page: something in it is no geom (a site, a tendon, …)."
        )
    return list(seen)


def _headlight(model: mujoco.MjModel) -> dict[str, Any] | None:
    light = model.vis.headlight
    if not light.active:
        return None
    return {
        "ambient": _listed(light.ambient),
        "diffuse": _listed(light.diffuse),
        "specular": _listed(light.specular),
    }


def _quaternion(matrix: Numbers) -> Numbers:
    """Return a rotation matrix, 9 numbers, as a quaternion wxyz."""
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, matrix)
    return quaternion


def _listed(values: Any) -> list[float]:
    return [round(float(value), 7) for value in values]
