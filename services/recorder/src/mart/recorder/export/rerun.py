"""Write an episode for rerun's viewer: its world in 3D, its pictures, its actions and observations over time.

`rerun-sdk` is no part of a plain installation: it is half a gigabyte, viewer included.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import InvalidInput, NotFound, Unavailable
from mart.protocol.messages import State
from mart.recorder.catalogue.pictures import frames_of as pictures_of
from mart.recorder.export.foxglove import Shown
from mart.recorder.export.model_frames import frames_of
from mart.render.visual_geoms import WORLD, BodyFrames, VisualGeom

TICK, TIME = "tick", "time"
_SHADOW = "shadow"
# Okabe & Ito's, which stay apart for colour-blind people.
_COLORS = (0xD55E00FF, 0x009E73FF, 0x0072B2FF, 0xE69F00FF, 0xCC79A7FF, 0x56B4E9FF, 0x808080FF)
_BACKDROP = (46, 52, 60)
_EYE_M, _TARGET_M = (1.3, -1.5, 1.1), (0.0, 0.0, 0.15)  # in the world: the table top is at z = 0
_ACTION = ("x", "y", "z", "turn x", "turn y", "turn z", "gripper")


def write_rerun(file: EpisodeFile, path: Path) -> Shown:
    """Write one episode to `path`.

    Raises Unavailable where rerun is not installed, Corrupt where the file is damaged, InvalidInput where its states
    are no model's.
    """
    rr = _rerun()
    frames, states = frames_of(file), list(file.states())
    if not states:
        raise InvalidInput(f"{file.path} holds no state; there is nothing to be shown.")
    recording = rr.RecordingStream("mart", recording_id=file.path.stem)
    recording.save(str(path), default_blueprint=_blueprint(states[0], _cameras(file)))
    times = [
        rr.TimeColumn(TICK, sequence=[state.episode_tick for state in states]),
        rr.TimeColumn(TIME, timestamp=np.array([s.stamps.sent_ns for s in states], "datetime64[ns]")),
    ]
    moving = 0
    if frames is not None and all(state.integration_state for state in states):
        moving = _log_world(recording, frames, states, times)
    logged = _log_numbers(recording, states, times)
    for camera in _cameras(file):
        logged += _log_pictures(recording, file, camera)
    recording.flush()
    recording.disconnect()
    return Shown(logged + moving * len(states), len(states) - 1, moving)


def _rerun() -> Any:
    try:
        import rerun
    except ImportError as error:
        raise Unavailable(
            "rerun is not installed here; `pip install 'mart-recorder[rerun]'` brings it (500 MB with its viewer)."
        ) from error
    return rerun


def _log_world(recording: Any, frames: BodyFrames, states: Sequence[State], times: list[Any]) -> int:
    """Log what bodies look like, once, and where they are, each tick; return how many move."""
    rr = _rerun()
    recording.log(WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for geom in frames.geoms():
        if geom.rgba[3] > 0 and not geom.body.endswith(_SHADOW):
            recording.log(f"{_body_path(geom.body)}/{_part(geom.name)}", *_shape(geom), static=True)
    poses = [frames.poses(state.integration_state) for state in states]
    for index, name in enumerate(frames.names):
        columns = rr.Transform3D.columns(
            translation=np.array([positions[index] for positions, _ in poses]),
            quaternion=np.array([quaternions[index][[1, 2, 3, 0]] for _, quaternions in poses]),
        )
        recording.send_columns(_body_path(name), indexes=times, columns=columns)
    return len(frames.names)


def _shape(geom: VisualGeom) -> tuple[Any, ...]:
    """Return a shape of rerun's and where it is on its body."""
    rr = _rerun()
    color = [np.rint(np.clip(geom.rgba, 0, 1) * 255).astype(np.uint8).tolist()]
    x, _, z = half = geom.half_size_m.tolist()
    place = rr.Transform3D(
        translation=geom.position_m, quaternion=rr.Quaternion(xyzw=geom.quaternion_wxyz[[1, 2, 3, 0]])
    )
    solid = {"colors": color, "fill_mode": "solid"}
    match geom.kind:
        case "mesh":
            corners, normals = _flat_shaded(geom)
            shape = rr.Mesh3D(vertex_positions=corners, vertex_normals=normals, albedo_factor=color[0])
        case "box":
            shape = rr.Boxes3D(half_sizes=[half], **solid)
        case "plane":
            shape = rr.Boxes3D(half_sizes=[[*half[:2], 0.0005]], **solid)
        case "ellipsoid":
            shape = rr.Ellipsoids3D(half_sizes=[half], **solid)
        case "cylinder":
            shape = rr.Cylinders3D(lengths=[2 * z], radii=[x], **solid)
        case _:  # rerun's capsule begins at its lower end
            shape = rr.Capsules3D(lengths=[2 * z], radii=[x], translations=[[0, 0, -z]], **solid)
    return shape, place


def _flat_shaded(geom: VisualGeom) -> tuple[Any, Any]:
    """Return a mesh's corners, three a triangle, and the triangle's normal at each: rerun lights no mesh without."""
    corners = geom.vertices_m[geom.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return corners.reshape(-1, 3), np.repeat(normals, 3, axis=0)


def _log_numbers(recording: Any, states: Sequence[State], times: list[Any]) -> int:
    """Log actions by arm and every observation; return how many rows that are."""
    rr = _rerun()
    logged = 0
    for index, arm in enumerate(states[0].arms):
        path = f"action/{arm.arm}"
        recording.log(path, rr.SeriesLines(names=list(_ACTION), colors=list(_COLORS)), static=True)
        later = [rr.TimeColumn(TICK, sequence=[s.episode_tick for s in states[1:]])]
        later.append(
            rr.TimeColumn(TIME, timestamp=np.array([s.stamps.sent_ns for s in states[1:]], "datetime64[ns]"))
        )
        actions = np.array([state.arms[index].action for state in states[1:]])
        recording.send_columns(path, indexes=later, columns=_scalars(actions))
        logged += len(actions)
    for seen in states[0].observations:
        values = np.array(
            [next(o.value for o in state.observations if o.name == seen.name) for state in states]
        )
        recording.send_columns(f"observation/{seen.name}", indexes=times, columns=_scalars(values))
        logged += len(values)
    return logged


def _scalars(values: Any) -> Any:
    """Return a column with so many numbers a row."""
    return _rerun().Scalars.columns(scalars=values.ravel()).partition([values.shape[1]] * len(values))


def _log_pictures(recording: Any, file: EpisodeFile, camera: str) -> int:
    rr = _rerun()
    path = f"view/{camera}"
    recording.log(path, rr.VideoStream(codec=rr.VideoCodec.H264), static=True)
    logged = 0
    try:
        for picture in pictures_of(file, camera):
            recording.set_time(TIME, timestamp=np.datetime64(picture.image_ns, "ns"))
            recording.log(path, rr.VideoStream.from_fields(sample=picture.data))
            logged += 1
    except NotFound:
        return 0  # nothing to begin with
    finally:
        recording.reset_time()
    return logged


def _cameras(file: EpisodeFile) -> list[str]:
    topics = {message.topic for message in file.messages() if message.topic.endswith("/video")}
    return sorted(topic.split("/")[-2] for topic in topics)


def _blueprint(first: State, cameras: Sequence[str]) -> Any:
    """Return what the viewer shows at once: the world on the left, pictures above plots on the right."""
    import rerun.blueprint as rrb

    plots = [rrb.TimeSeriesView(origin=f"action/{arm.arm}", name=f"{arm.arm}: action") for arm in first.arms]
    seen = plots or [rrb.TimeSeriesView(origin="observation/action", name="action")]
    views = [rrb.Spatial2DView(origin=f"view/{camera}", name=camera) for camera in cameras]
    right = rrb.Vertical(*([rrb.Horizontal(*views)] if views else []), *seen)
    world = rrb.Spatial3DView(
        origin=WORLD,
        name="world",
        background=rrb.Background(color=_BACKDROP, kind="SolidColor"),
        eye_controls=rrb.EyeControls3D(position=_EYE_M, look_target=_TARGET_M, eye_up=(0.0, 0.0, 1.0)),
    )
    return rrb.Blueprint(rrb.Horizontal(world, right), collapse_panels=True)


def _body_path(body: str) -> str:
    return WORLD if body == WORLD else f"{WORLD}/{_part(body)}"


def _part(name: str) -> str:
    """Return a name as one part of an entity's path, which slashes would divide."""
    return name.replace("/", "_").replace(" ", "_")
