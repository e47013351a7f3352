"""Say in Foxglove's messages what a model looks like and where its bodies are. Pure."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable

import numpy as np
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CubePrimitive_pb2 import CubePrimitive
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
from foxglove_schemas_protobuf.TriangleListPrimitive_pb2 import TriangleListPrimitive
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.timestamp_pb2 import Timestamp
from numpy.typing import NDArray

from mart.render.visual_geoms import WORLD, VisualCamera, VisualGeom

Numbers = NDArray[np.float64]

_FLAT_M = 0.001  # how thick a plane is drawn
_SHADOW = "shadow"  # of a body's name: discs that MART's pictures lay on the table


def frame_id(body: str) -> str:
    """Return the frame of a body; bodies stand apart from the frames of bases and tools that are recorded."""
    return WORLD if body == WORLD else f"body/{body}"


def scene_update(geoms: Iterable[VisualGeom], at_ns: int) -> SceneUpdate:
    """Return one entity for each body, which stays and follows its frame."""
    entities: dict[str, SceneEntity] = defaultdict(SceneEntity)
    for geom in geoms:
        if geom.rgba[3] > 0 and not geom.body.endswith(_SHADOW):
            _add(entities[geom.body], geom)
    for body, entity in entities.items():
        entity.timestamp.CopyFrom(_timestamp(at_ns))
        entity.frame_id, entity.id, entity.frame_locked = frame_id(body), body, True
    return SceneUpdate(entities=entities.values())


def frame(parent: str, child: str, position_m: Numbers, quaternion: Numbers, at_ns: int) -> FrameTransform:
    """Return where a frame is in its parent's; quaternion wxyz."""
    return FrameTransform(
        timestamp=_timestamp(at_ns),
        parent_frame_id=parent,
        child_frame_id=child,
        translation=_vector(position_m),
        rotation=_quaternion(quaternion),
    )


def camera_frame(camera: VisualCamera, at_ns: int) -> FrameTransform:
    """Return where a camera stands; its frame has the name that its recorded pictures have."""
    return frame(WORLD, camera.name, camera.position_m, camera.quaternion_wxyz, at_ns)


def calibration(camera: VisualCamera, size_px: tuple[int, int], at_ns: int) -> CameraCalibration:
    """Return how a camera looks, for pictures of this size, the strip of tick codes below them included."""
    width, height = size_px
    seen_px = min(height, round(width * 3 / 4))  # the world's part of the picture is four wide and three high
    focal_px = seen_px / 2 / math.tan(math.radians(camera.fov_y_deg) / 2)
    center = (width / 2, seen_px / 2)
    return CameraCalibration(
        timestamp=_timestamp(at_ns),
        frame_id=camera.name,
        width=width,
        height=height,
        K=[focal_px, 0, center[0], 0, focal_px, center[1], 0, 0, 1],
        R=[1, 0, 0, 0, 1, 0, 0, 0, 1],
        P=[focal_px, 0, center[0], 0, 0, focal_px, center[1], 0, 0, 0, 1, 0],
    )


def _add(entity: SceneEntity, geom: VisualGeom) -> None:
    pose, color = _pose(geom.position_m, geom.quaternion_wxyz), _color(geom.rgba)
    x, y, z = geom.half_size_m.tolist()
    match geom.kind:
        case "box":
            entity.cubes.append(
                CubePrimitive(pose=pose, color=color, size=Vector3(x=2 * x, y=2 * y, z=2 * z))
            )
        case "plane":
            size = Vector3(x=2 * x, y=2 * y, z=_FLAT_M)
            entity.cubes.append(CubePrimitive(pose=pose, color=color, size=size))
        case "ellipsoid":
            size = Vector3(x=2 * x, y=2 * y, z=2 * z)
            entity.spheres.append(SpherePrimitive(pose=pose, color=color, size=size))
        case "cylinder" | "capsule":
            entity.cylinders.append(
                CylinderPrimitive(
                    pose=pose,
                    color=color,
                    size=Vector3(x=2 * x, y=2 * y, z=2 * z),
                    bottom_scale=1,
                    top_scale=1,
                )
            )
            if geom.kind == "capsule":
                entity.spheres.extend(_ends(geom, color))
        case "mesh":
            points = [Point3(x=x, y=y, z=z) for x, y, z in geom.vertices_m.tolist()]
            indices = geom.triangles.ravel().tolist()
            entity.triangles.append(
                TriangleListPrimitive(pose=pose, color=color, points=points, indices=indices)
            )


def _ends(geom: VisualGeom, color: Color) -> list[SpherePrimitive]:
    radius, _, half_m = geom.half_size_m.tolist()
    w, x, y, z = geom.quaternion_wxyz.tolist()
    axis = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    size = Vector3(x=2 * radius, y=2 * radius, z=2 * radius)
    places = (geom.position_m + half_m * axis, geom.position_m - half_m * axis)
    return [SpherePrimitive(pose=_pose(at, geom.quaternion_wxyz), color=color, size=size) for at in places]


def _pose(position_m: Numbers, quaternion: Numbers) -> Pose:
    return Pose(position=_vector(position_m), orientation=_quaternion(quaternion))


def _vector(values: Numbers) -> Vector3:
    x, y, z = values.tolist()
    return Vector3(x=x, y=y, z=z)


def _quaternion(wxyz: Numbers) -> Quaternion:
    w, x, y, z = wxyz.tolist()
    return Quaternion(x=x, y=y, z=z, w=w)


def _color(rgba: Numbers) -> Color:
    r, g, b, a = rgba.tolist()
    return Color(r=r, g=g, b=b, a=a)


def _timestamp(ns: int) -> Timestamp:
    seconds, nanos = divmod(ns, 1_000_000_000)
    return Timestamp(seconds=seconds, nanos=nanos)
