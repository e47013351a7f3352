"""A file is read by the stock `mcap` reader and protobuf decoder, without any of our code."""

from __future__ import annotations

import io
from importlib import import_module
from pathlib import Path

import av
import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from mart.episodes.mcap_entries import video_entry
from mart.protocol import codec
from mart.recorder.record.finalize import finalize
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part

_SCHEMAS = {
    "/state": "mart.v1.State",
    "/event": "mart.v1.Event",
    "/arm/arm0/command": "mart.v1.Command",
    "/view/arm0/video": "foxglove.CompressedVideo",
    "/tf": "foxglove.FrameTransforms",
    "/arm/arm0/gripper": "foxglove.JointStates",
    "/arm/arm1/gripper": "foxglove.JointStates",
}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_episode(tmp_path_factory.mktemp("episodes")).path


def test_every_topic_has_the_schema_of_the_specification(path: Path) -> None:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    channels = {
        channel.topic: summary.schemas[channel.schema_id].name for channel in summary.channels.values()
    }
    assert channels == _SCHEMAS
    assert {schema.encoding for schema in summary.schemas.values()} == {"protobuf"}
    assert {channel.message_encoding for channel in summary.channels.values()} == {"protobuf"}


def test_every_message_decodes_by_the_schema_in_the_file(path: Path) -> None:
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        decoded = {channel.topic: message for _, channel, _, message in reader.iter_decoded_messages()}
    assert decoded["/state"].tick == 30
    frames = {frame.child_frame_id: frame for frame in decoded["/tf"].transforms}
    assert set(frames) == {"arm0/base", "arm1/base", "arm0/tool", "arm1/tool"}
    assert frames["arm0/tool"].parent_frame_id == "arm0/base"
    assert frames["arm0/base"].parent_frame_id == "world"
    assert decoded["/arm/arm1/gripper"].joints[0].position == 0.25
    assert decoded["/view/arm0/video"].format == "h264"


def test_foxgloves_own_schemas_are_unchanged(path: Path) -> None:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    for schema in summary.schemas.values():
        package, name = schema.name.rsplit(".", 1)
        if package == "foxglove":
            official = getattr(import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name).DESCRIPTOR
            in_file = FileDescriptorSet.FromString(schema.data)
            by_name = {file.name: file.SerializeToString() for file in in_file.file}
            assert by_name[official.file.name] == official.file.serialized_pb


def test_times_are_arrival_and_sending(path: Path) -> None:
    with path.open("rb") as file:
        times = [
            (message.log_time, message.publish_time)
            for _, _, message in make_reader(file).iter_messages(topics="/state")
        ]
    assert times[3] == (synthetic.wall_ns(3), synthetic.wall_ns(3) + 2_000_000)


def test_the_bytes_are_those_of_the_wire(path: Path) -> None:
    with path.open("rb") as file:
        recorded = [message.data for _, _, message in make_reader(file).iter_messages(topics="/state")]
    assert recorded == [codec.encode(state) for state in synthetic.states(30)]


def test_the_model_and_the_metadata_are_there(path: Path) -> None:
    with path.open("rb") as file:
        reader = make_reader(file)
        assert [(a.name, a.data) for a in reader.iter_attachments()] == [("model.mjb", synthetic.MJB)]
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
        assert reader.get_header().profile == "mart"
    assert metadata["mart.episode"]["outcome"] == "success"
    assert metadata["mart.episode"]["seed"] == "42"
    assert metadata["mart.operators"] == {"arm0": "human Ana", "arm1": "hold"}
    assert metadata["mart.verification"]["verdict"] == "verified"
    assert metadata["mart.verification"]["mujoco_version"] == "4.0.0"
    assert float(metadata["mart.cadence"]["real_time_factor"]) == pytest.approx(1.0)
    assert "mart-recorder" in metadata["mart.versions"]


def test_the_name_tells_date_room_number_and_task(path: Path) -> None:
    assert path.parts[-2:] == ("2026-09-21", "room-1-0001-two_arm_multi_cube_lifting.mcap")


def test_video_decodes_with_a_stock_decoder(tmp_path: Path) -> None:
    packets = _encoded(frames=12)
    file, episode, facts = write_part(tmp_path, synthetic.states(5))
    for i, packet in enumerate(packets):
        video = synthetic.video(i, is_key=False, data=packet)
        file.add(video_entry("front", video, codec.encode(video), synthetic.wall_ns(i)))
    path = finalize(file, episode, facts, tmp_path, by_toy_replica, repaired=False).path

    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        messages = reader.iter_decoded_messages(topics="/view/front/video")
        data = b"".join(message.decoded_message.data for message in messages)
    with av.open(io.BytesIO(data), format="h264") as container:
        assert isinstance(container, av.container.InputContainer)
        sizes = [(frame.width, frame.height) for frame in container.decode(video=0)]
    assert sizes == [(64, 48)] * 12


def _encoded(frames: int) -> list[bytes]:
    """H.264 as a gateway makes it: one frame a packet, parameter sets with each key frame, no B-frames."""
    encoder = av.CodecContext.create("libx264", "w")
    assert isinstance(encoder, av.VideoCodecContext)
    encoder.width, encoder.height, encoder.pix_fmt = 64, 48, "yuv420p"
    encoder.options = {"preset": "ultrafast", "tune": "zerolatency"}
    images = (np.full((48, 64, 3), 20 * i, dtype=np.uint8) for i in range(frames))
    packets = [p for image in images for p in encoder.encode(av.VideoFrame.from_ndarray(image, "rgb24"))]
    return [bytes(packet) for packet in [*packets, *encoder.encode(None)]]
