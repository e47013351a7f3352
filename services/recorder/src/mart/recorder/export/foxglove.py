"""Write an episode for Foxglove and Lichtblick: its messages as they are, and what draws its world in 3D.

Added are, of an episode that carries its model: `/scene`, once, what every body looks like; `/tf` for every body once a
tick, beside what was recorded there; and how each camera looks at it. The file has no profile, so that nobody takes it
for an episode of MART's again.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import av
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from google.protobuf.message import Message
from mcap.well_known import MessageEncoding
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import register_schema

from mart.episodes.reader import EpisodeFile, RecordedMessage
from mart.protocol import codec
from mart.protocol.messages import Command, Event, State
from mart.protocol.recording import EVENT, STATE, TRANSFORMS
from mart.recorder.export import foxglove_scene as scene
from mart.recorder.export.model_frames import frames_of
from mart.render.visual_geoms import WORLD, BodyFrames

SCENE = "/scene"
_SIZE_PX = (640, 496)  # of a picture where none was recorded, the strip of tick codes with it
_ENDINGS: tuple[tuple[str, type[Message]], ...] = (
    ("/command", Command),
    ("/video", CompressedVideo),
    ("/gripper", JointStates),
)


@dataclass(frozen=True)
class Shown:
    """Tell how much of an episode was written. bodies: how many move in 3D; 0 where it carries no model."""

    messages: int
    ticks: int
    bodies: int


def write_foxglove(file: EpisodeFile, path: Path) -> Shown:
    """Write one episode to `path`. Raises Corrupt where it is damaged, InvalidInput where its states are no model's."""
    frames = frames_of(file)
    with path.open("wb") as out:
        writer = _SceneWriter(out)
        for name, strings in file.metadata.items():
            writer.describe(name, dict(strings))
        sizes = dict(_picture_sizes(file))
        ticks = began = 0
        for message in file.messages():
            if frames is not None and not began:
                began = message.arrived_ns
                _write_scene(writer, frames, sizes, began)
            writer.pass_on(message)
            if message.topic == STATE:
                ticks += 1
                if frames is not None:
                    _write_poses(writer, frames, message)
        writer.finish()
    return Shown(writer.messages, max(ticks - 1, 0), 0 if frames is None else len(frames.names))


def _write_scene(
    writer: _SceneWriter, frames: BodyFrames, sizes: dict[str, tuple[int, int]], at_ns: int
) -> None:
    cameras = list(frames.cameras())
    writer.add(SCENE, scene.scene_update(frames.geoms(), at_ns), at_ns, at_ns)
    views = FrameTransforms(transforms=[scene.camera_frame(camera, at_ns) for camera in cameras])
    writer.add(TRANSFORMS, views, at_ns, at_ns)
    for camera in cameras:
        size = sizes.get(camera.name, _SIZE_PX)
        writer.add(f"/view/{camera.name}/calibration", scene.calibration(camera, size, at_ns), at_ns, at_ns)


def _write_poses(writer: _SceneWriter, frames: BodyFrames, message: RecordedMessage) -> None:
    state = codec.decode(State, message.payload)
    if not state.integration_state:
        return
    positions, quaternions = frames.poses(state.integration_state)
    moved = [
        scene.frame(WORLD, scene.frame_id(name), position, quaternion, message.sent_ns)
        for name, position, quaternion in zip(frames.names, positions, quaternions, strict=True)
    ]
    writer.add(TRANSFORMS, FrameTransforms(transforms=moved), message.arrived_ns, message.sent_ns)


def _picture_sizes(file: EpisodeFile) -> Iterator[tuple[str, tuple[int, int]]]:
    """Iterate over the cameras that were recorded, each with the width and height of its first picture in pixels."""
    seen: set[str] = set()
    for message in file.messages():
        parts = message.topic.split("/")
        if parts[-1] != "video" or parts[-2] in seen:
            continue
        size = _size_of(codec.decode(CompressedVideo, message.payload).data)
        if size is not None:
            seen.add(parts[-2])
            yield parts[-2], size


def _size_of(data: bytes) -> tuple[int, int] | None:
    """Return the size of an encoded picture, None where it does not say it (no key frame)."""
    try:
        with av.open(io.BytesIO(data), format="h264") as container:
            stream = container.streams.video[0]
            return (stream.width, stream.height) if stream.width and stream.height else None
    except (av.error.FFmpegError, IndexError):
        return None


class _SceneWriter:
    def __init__(self, out: io.BufferedWriter) -> None:
        self._mcap = Writer(out, compression=CompressionType.ZSTD, enable_data_crcs=True)
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, str], int] = {}
        self.messages = 0
        self._mcap.start()

    def describe(self, name: str, strings: dict[str, str]) -> None:
        self._mcap.add_metadata(name, strings)

    def pass_on(self, message: RecordedMessage) -> None:
        """Write a recorded message as it is; what no episode of ours holds is passed by."""
        schema = _schema_of(message.topic)
        if schema is not None:
            self._write(message, schema)

    def add(self, topic: str, message: Message, arrived_ns: int, sent_ns: int) -> None:
        payload = message.SerializeToString()
        self._write(RecordedMessage(topic, payload, arrived_ns, sent_ns, 0), type(message))

    def finish(self) -> None:
        self._mcap.finish()  # type: ignore[no-untyped-call]

    def _write(self, message: RecordedMessage, schema: type[Message]) -> None:
        name = schema.DESCRIPTOR.full_name
        if name not in self._schemas:
            self._schemas[name] = register_schema(self._mcap, schema)
        key = (message.topic, name)
        if key not in self._channels:
            made = self._mcap.register_channel(message.topic, MessageEncoding.Protobuf, self._schemas[name])
            self._channels[key] = made
        self._mcap.add_message(
            self._channels[key], message.arrived_ns, message.payload, message.sent_ns, message.sequence
        )
        self.messages += 1


def _schema_of(topic: str) -> type[Message] | None:
    whole: dict[str, type[Message]] = {STATE: State, EVENT: Event, TRANSFORMS: FrameTransforms}
    if topic in whole:
        return whole[topic]
    return next((schema for ending, schema in _ENDINGS if topic.endswith(ending)), None)
