"""Turn messages into what is written into a file: their very bytes, and what is derived from states."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointState_pb2 import JointState
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.message import Message
from google.protobuf.timestamp_pb2 import Timestamp

from mart.protocol import recording
from mart.protocol.errors import MartError
from mart.protocol.messages import Command, Event, PoseMessage, State, pose_message
from mart.protocol.tasks import Arm, get_task

_SEQUENCE_MASK = 0xFFFFFFFF  # MCAP has 32 bits for it


@dataclass(frozen=True)
class McapEntry:
    """Hold one message on its way into a file: its bytes as they were on the wire, and its stamps (Unix time).

    sent_ns: the arrival where the sender gave no stamp. sequence: lower 32 bits.
    """

    topic: str
    schema: type[Message]
    payload: bytes
    arrived_ns: int
    sent_ns: int
    sequence: int = 0


def state_entries(
    state: State, payload: bytes, arrived_ns: int, task: str | None, arm_kinds: Sequence[str] = ()
) -> list[McapEntry]:
    """Return the state itself and what tools without MART's schemas can draw: frames, and grippers where there are.

    arm_kinds: one for each arm, none of them: Pandas; where bases stand and which arms have fingers depends on it.
    """
    sent_ns = state.stamps.sent_ns or arrived_ns
    sequence = state.tick & _SEQUENCE_MASK

    def entry(topic: str, message: Message, raw: bytes) -> McapEntry:
        return McapEntry(topic, type(message), raw, arrived_ns, sent_ns, sequence)

    known = _known_arms(task, len(state.arms), arm_kinds)
    bases = [(arm.name, pose_message(arm.pose_base_in_world)) for arm in known]
    without = {arm.name for arm in known if not arm.kind.has_fingers}
    frames = _frames(state, sent_ns, bases)
    grippers = [
        (recording.gripper_topic(arm.arm), _gripper(arm.gripper, sent_ns))
        for arm in state.arms
        if arm.arm not in without
    ]
    return [
        entry(recording.STATE, state, payload),
        entry(recording.TRANSFORMS, frames, frames.SerializeToString()),
        *(entry(topic, gripper, gripper.SerializeToString()) for topic, gripper in grippers),
    ]


def command_entry(arm: str, command: Command, payload: bytes, arrived_ns: int) -> McapEntry:
    """Return a command for this arm as it is written."""
    sent_ns = command.stamps.sent_ns or arrived_ns
    sequence = command.sequence & _SEQUENCE_MASK
    return McapEntry(recording.command_topic(arm), Command, payload, arrived_ns, sent_ns, sequence)


def video_entry(camera: str, video: CompressedVideo, payload: bytes, arrived_ns: int) -> McapEntry:
    """Return one encoded picture of this camera as it is written."""
    sent_ns = video.timestamp.ToNanoseconds() if video.HasField("timestamp") else 0
    topic = recording.video_topic(camera)
    return McapEntry(topic, CompressedVideo, payload, arrived_ns, sent_ns if sent_ns > 0 else arrived_ns)


def event_entry(event: Event, payload: bytes, arrived_ns: int) -> McapEntry:
    """Return an event as it is written."""
    return McapEntry(recording.EVENT, Event, payload, arrived_ns, event.wall_ns or arrived_ns)


def _frames(state: State, sent_ns: int, bases: Iterable[tuple[str, PoseMessage]]) -> FrameTransforms:
    transforms = [_frame("world", f"{arm}/base", pose, sent_ns) for arm, pose in bases]
    transforms += [_frame(f"{a.arm}/base", f"{a.arm}/tool", a.tool_in_base, sent_ns) for a in state.arms]
    return FrameTransforms(transforms=transforms)


def _known_arms(task: str | None, arms: int, arm_kinds: Sequence[str]) -> tuple[Arm, ...]:
    """Return the arms as the task's catalogue entry has them; nothing for a task that is not in the catalogue."""
    try:
        return get_task(task or "", arms, arm_kinds).arms
    except MartError:
        return ()


def _frame(parent: str, child: str, pose: PoseMessage, sent_ns: int) -> FrameTransform:
    return FrameTransform(
        timestamp=_timestamp(sent_ns),
        parent_frame_id=parent,
        child_frame_id=child,
        translation=Vector3(x=pose.x, y=pose.y, z=pose.z),
        rotation=Quaternion(x=pose.qx, y=pose.qy, z=pose.qz, w=pose.qw),
    )


def _gripper(position: float, sent_ns: int) -> JointStates:
    return JointStates(timestamp=_timestamp(sent_ns), joints=[JointState(name="gripper", position=position)])


def _timestamp(ns: int) -> Timestamp:
    seconds, nanos = divmod(ns, 1_000_000_000)
    return Timestamp(seconds=seconds, nanos=nanos)
