"""One filled example of every message that travels on its own, and a strategy for arbitrary ones."""

from __future__ import annotations

from typing import Any

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from hypothesis import strategies as st

from mart.protocol import messages as m

_STAMP = 1_700_000_000_000_000_000


_POSE = m.PoseMessage(x=0.45, y=-0.1, z=0.2, qw=0.5, qx=-0.5, qy=0.5, qz=0.5)
_STAMPS = m.CommandStamps(input_sent_ns=_STAMP, gateway_received_ns=_STAMP + 1, sent_ns=_STAMP + 2)
_SEAT = m.Seat(arm="arm0", operator=m.OPERATOR_HUMAN, epoch=7, holder_id="h1", name="Ana", ready=True)
_PROGRESS = m.Progress(subtasks=[m.Subtask(name="cube0_lifted", done=True)], success_ticks=3)


def examples() -> dict[str, Message]:
    """By message name; the golden bytes are made from these."""
    filled = (*_driving(), *_room(), *_signalling(), *_rollouts(), *_training())
    return {message.DESCRIPTOR.name: message for message in filled}


def _driving() -> tuple[Message, ...]:
    arm = m.ArmState(
        arm="arm0",
        tool_in_base=_POSE,
        gripper=0.2,
        action=[0.1, -1.0, 1.0, 0.0, 0.5, -0.5, 1.0],
        sequence=42,
        arrived_ns=_STAMP + 4,
        stamps=_STAMPS,
        source=m.OPERATOR_HUMAN,
        seat_epoch=7,
        engaged=True,
        fresh=True,
    )
    command = m.Command(
        arm="arm0",
        seat_epoch=7,
        sequence=42,
        target_tool_in_base=_POSE,
        gripper=0.25,
        engaged=True,
        source=m.OPERATOR_HUMAN,
        stamps=_STAMPS,
        seen_tick=1234,
    )
    state = m.State(
        room="room-1",
        tick=1235,
        sim_time_s=61.75,
        stamps=m.TickStamps(due_ns=_STAMP, fired_ns=_STAMP + 5, stepped_ns=_STAMP + 9, sent_ns=_STAMP + 10),
        real_time_factor=0.99,
        integration_state=bytes(range(16)),
        arms=[arm],
        straggler="arm0",
        straggler_late_s=0.012,
        observations=[m.Observation(name="cube0/position", value=[0.1, 0.2, 0.02])],
        progress=_PROGRESS,
        episode=3,
        episode_tick=17,
        boot=_STAMP,
    )
    return command, state


def _room() -> tuple[Message, ...]:
    status = m.RoomStatus(
        room="room-1",
        task="two_arm_multi_cube_lifting",
        control_hz=20.0,
        tick=1235,
        real_time_factor=0.98,
        barrier=m.BARRIER_PHASE_STALLED,
        waiting_for=[m.Waiting(arm="arm1", since_s=0.8)],
        seats=[_SEAT],
        episode=m.Episode(number=3, phase=m.EPISODE_PHASE_RECORDING, ticks=17, elapsed_s=0.85, seed=9),
        progress=_PROGRESS,
        episodes_saved=2,
        episodes_good=1,
        plan=m.Plan(episodes=50, good=1),
        wall_ns=_STAMP,
        boot=_STAMP,
    )
    claim = m.SeatRequest.Claim(arm="arm0", holder_id="h1", name="Ana", operator=m.OPERATOR_HUMAN)
    finish = m.EpisodeRequest.Finish(holder_id="h1", outcome=m.OUTCOME_SUCCESS)
    saved = m.Event.EpisodeSaved(
        number=3, path="episodes/x.mcap", verified=True, size_bytes=10, outcome=m.OUTCOME_SUCCESS
    )
    return (
        status,
        m.SeatRequest(claim=claim),
        m.EpisodeRequest(finish=finish),
        m.RoomReply(error=m.Error(code="Conflict", message="arm0 is held by Ana."), seat=_SEAT),
        m.Event(wall_ns=_STAMP, room="room-1", tick=1235, episode_saved=saved),
        m.Event.CueGiven(arm="arm0", cue=m.CUE_WAIT),
    )


def _signalling() -> tuple[Message, ...]:
    return (
        m.Offer(token="t", sdp="v=0"),
        m.Answer(sdp="v=0"),
        m.OpenSeat(room="room-1", arm="arm0", seat_epoch=7),
    )


def _rollouts() -> tuple[Message, ...]:
    model = m.Model(
        sha256="ab", mjb=b"\x00\x01", task="t", control_hz=20.0, arms=["arm0"], mujoco_version="4.0.0"
    )
    resimulate = m.RolloutRequest.Resimulate(
        model_sha256="ab", task="t", control_hz=20.0, first_state=b"\x01", actions=b"\x02" * 8
    )
    worlds = m.WorldArrays(
        observations=b"\x04" * 16,
        subtasks=b"\x01\x00",
        success_ticks=b"\x05\x00\x00\x00",
        success=b"\x00",
        failed=["Cube 0 fell off the table."],
        sim_time_s=b"\x06" * 8,
        integration_states=b"\x07" * 8,
    )
    reply = m.RolloutReply(session="12ab34cd-1", worlds=worlds, state_digests=b"\x03" * 16)
    return model, m.RolloutRequest(resimulate=resimulate), reply


def _training() -> tuple[Message, ...]:
    order = m.Order(model="r-HBC", task="t", data="episodes", preset="fast", seeds=[0, 1, 2])
    job = m.Job(
        id="job-0007", sweep="sweep-0002", order=order, state=m.JOB_STATE_RUNNING, submitted_ns=_STAMP
    )
    evaluation = m.Evaluation(updates=500, purpose="score", episodes=100, successes=87, low=0.79, high=0.92)
    curve = m.Curve(name="loss/actor", updates=[1, 2], values=[0.5, 0.25])
    details = m.TrainerReply.Details(job=job, curves=[curve], evaluations=[evaluation])
    submit = m.TrainerRequest.Submit(models=["HBC", "r-HBC"], tasks=["t"], order=order, executor="local")
    return m.TrainerRequest(submit=submit), m.TrainerReply(jobs=[job], details=details)


_SCALARS = {
    FieldDescriptor.CPPTYPE_DOUBLE: st.floats(allow_nan=False),
    FieldDescriptor.CPPTYPE_UINT32: st.integers(0, 2**32 - 1),
    FieldDescriptor.CPPTYPE_UINT64: st.integers(0, 2**64 - 1),
    FieldDescriptor.CPPTYPE_BOOL: st.booleans(),
}


def printable_text(*, min_size: int = 0, max_size: int) -> st.SearchStrategy[str]:
    """Text for which `str.isprintable` holds: drawn of such letters, since texts thrown away slow the search."""
    letters = st.characters(exclude_categories=["C", "Z"], include_characters=" ")
    return st.text(letters, min_size=min_size, max_size=max_size)


def arbitrary(kind: type[Message]) -> st.SearchStrategy[Message]:
    """Any message of this kind, built from its descriptor: a new field is covered without touching a test."""
    return st.fixed_dictionaries(
        {}, optional={field.name: _field_values(field) for field in kind.DESCRIPTOR.fields}
    ).map(lambda values: kind(**_one_of_each(kind, values)))


def _one_of_each(kind: type[Message], values: dict[str, object]) -> dict[str, object]:
    """Keeps one member of every oneof."""
    kept = dict(values)
    for oneof in kind.DESCRIPTOR.oneofs:
        members = [field.name for field in oneof.fields if field.name in kept]
        for name in members[1:]:
            del kept[name]
    return kept


def _field_values(field: Any) -> st.SearchStrategy[object]:
    values: st.SearchStrategy[object]
    if field.message_type is not None and field.message_type.GetOptions().map_entry:
        key, value = (_field_values(part) for part in field.message_type.fields)
        return st.dictionaries(key, value, max_size=3)
    if field.cpp_type == FieldDescriptor.CPPTYPE_MESSAGE:
        values = st.deferred(lambda: arbitrary(GetMessageClass(field.message_type)))
    elif field.cpp_type == FieldDescriptor.CPPTYPE_ENUM:
        values = st.sampled_from([value.number for value in field.enum_type.values])
    elif field.type == FieldDescriptor.TYPE_BYTES:
        values = st.binary(max_size=32)
    elif field.type == FieldDescriptor.TYPE_STRING:
        values = printable_text(max_size=16)
    else:
        values = _SCALARS[field.cpp_type]
    return st.lists(values, max_size=3) if field.is_repeated else values
