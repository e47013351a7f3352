"""A toy room: states whose integration states follow from the actions by a hash, so that a toy replica can step them.

Everything is decided by tick numbers: the same call gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from hashlib import blake2b, sha256

import numpy as np
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from google.protobuf.timestamp_pb2 import Timestamp

from mart.protocol import codec
from mart.protocol.messages import (
    EPISODE_PHASE_ENDED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    ArmState,
    Command,
    CommandStamps,
    EpisodePhase,
    Event,
    Model,
    Numerics,
    Outcome,
    PoseMessage,
    RolloutReply,
    RolloutRequest,
    RoomStatus,
    Seat,
    State,
    StateDifference,
    TickStamps,
)

ROOM = "room-1"
TASK = "two_arm_multi_cube_lifting"
ARMS = ("arm0", "arm1")
BOOT = 77
PERIOD_NS = 50_000_000
RESET = b"reset".ljust(64)  # as long as every state after it
START_NS = 1_790_000_000_000_000_000  # 2026-09-21, UTC
MJB = bytes(range(256)) * 40
NUMERICS = Numerics(processor="toy", libm="toy 1.0", mujoco_build="4.0.0 toy", fingerprint="aa")
MODEL = Model(
    sha256=sha256(MJB).hexdigest(), mjb=MJB, task=TASK, control_hz=20.0, arms=ARMS, mujoco_version="4.0.0",
    numerics=NUMERICS,
)  # fmt: skip


def wall_ns(tick: int) -> int:
    return START_NS + tick * PERIOD_NS


def action(tick: int, arm: int) -> list[float]:
    return [round(np.sin(tick + arm + k), 3) for k in range(6)] + [1.0]


def integration_state(tick: int) -> bytes:
    """Of the toy world after `tick`, which began at tick 0."""
    state = RESET
    for t in range(1, tick + 1):
        state = step(state, np.array([action(t, arm) for arm in range(len(ARMS))]))
    return state


def step(state: bytes, actions: np.ndarray) -> bytes:
    """actions: shape (arms, 7)."""
    return blake2b(state + actions.astype("<f8").tobytes(), digest_size=64).digest()


def resimulate(request: RolloutRequest.Resimulate) -> bytes:
    """A replica of the toy world."""
    actions = np.frombuffer(request.actions, "<f8").reshape(-1, request.arms, 7)
    state, digests = request.first_state, b""
    for tick_actions in actions:
        state = step(state, tick_actions)
        digests += blake2b(state, digest_size=16).digest()
    return digests


class ToyReplica:
    """A replica of the toy world on a processor of this fingerprint, with another where it steps natively.

    What is recorded on a processor of `follows` follows bit for bit; else it differs from the second tick on, by
    `differs_by` in one tick.
    """

    def __init__(
        self,
        fingerprint: str = "aa",
        native: str = "bb",
        follows: tuple[str, ...] = ("aa", "bb"),
        differs_by: float = 1e-9,
    ) -> None:
        self._fingerprints = {False: fingerprint, True: native}
        self._follows, self._differs_by = follows, differs_by

    def __call__(self, request: RolloutRequest) -> RolloutReply:
        asked = request.compare_ticks if request.HasField("compare_ticks") else request.resimulate
        fingerprint = self._fingerprints[asked.native]
        reply = RolloutReply(numerics=Numerics(processor="toy", fingerprint=fingerprint))
        if isinstance(asked, RolloutRequest.CompareTicks):
            reply.differences.extend(self._differences(asked, fingerprint))
        else:
            digests = resimulate(asked)
            reply.state_digests = (
                digests if fingerprint in self._follows else digests[:16] + bytes(len(digests) - 16)
            )
        return reply

    def _differences(self, asked: RolloutRequest.CompareTicks, fingerprint: str) -> Iterator[StateDifference]:
        actions = np.frombuffer(asked.actions, "<f8").reshape(-1, asked.arms, 7)
        states = [asked.states[i : i + 64] for i in range(0, len(asked.states), 64)]
        differ = [float(step(a, done) != b) for a, b, done in zip(states, states[1:], actions, strict=False)]
        if fingerprint not in self._follows:
            differ = [self._differs_by + one for one in differ]
        for group in ("positions", "velocities", "warm_start"):
            yield StateDifference(group=group, largest=max(differ), transition=int(np.argmax(differ)))


def rollout_reply(payload: bytes) -> bytes:
    return codec.encode(ToyReplica()(codec.decode(RolloutRequest, payload)))


def states(
    ticks: int, number: int = 1, first_tick: int = 0, boot: int = BOOT, room: str = ROOM
) -> list[State]:
    """An episode's states: the reset and `ticks` ticks after it. `first_tick`: of the room, at the reset."""
    made, world = [], RESET
    for i in range(ticks + 1):
        if i:
            world = step(world, np.array([action(i, arm) for arm in range(len(ARMS))]))
        made.append(_state(first_tick + i, i, world, number=number, boot=boot, room=room))
    return made


def _state(tick: int, episode_tick: int, world: bytes, *, number: int, boot: int, room: str) -> State:
    fired_ns = wall_ns(tick)
    return State(
        room=room,
        tick=tick,
        sim_time_s=episode_tick * 0.05,
        stamps=TickStamps(
            due_ns=fired_ns, fired_ns=fired_ns, stepped_ns=fired_ns, sent_ns=fired_ns + 2_000_000
        ),
        real_time_factor=1.0,
        integration_state=world,
        arms=[_arm(i, arm, episode_tick) for i, arm in enumerate(ARMS)],
        straggler="arm1" if episode_tick else "",
        straggler_late_s=0.01 if episode_tick else 0.0,
        episode=number,
        episode_tick=episode_tick,
        boot=boot,
    )


def _arm(index: int, arm: str, episode_tick: int) -> ArmState:
    return ArmState(
        arm=arm,
        tool_in_base=PoseMessage(x=0.5, y=0.01 * index, z=0.3, qw=1.0),
        gripper=0.25,
        action=action(episode_tick, index) if episode_tick else [],
        sequence=episode_tick,
        source=OPERATOR_HUMAN if index == 0 else OPERATOR_HOLD,
        seat_epoch=3 + index,
        fresh=index == 0 and episode_tick > 0,
    )


def command(sequence: int, arm: str = "arm0") -> Command:
    stamps = CommandStamps(sent_ns=wall_ns(sequence) - 10_000_000)
    return Command(arm=arm, seat_epoch=3, sequence=sequence, stamps=stamps, source=OPERATOR_HUMAN)


def commands_of(state: State) -> list[Command]:
    """The commands that a state names."""
    return [command(arm.sequence, arm.arm) for arm in state.arms if arm.fresh]


def started(number: int = 1, tick: int = 0) -> Event:
    return Event(
        wall_ns=wall_ns(tick),
        room=ROOM,
        tick=tick,
        episode_started=Event.EpisodeStarted(
            number=number, seed=42, seats=seats(), task=TASK, control_hz=20.0, model_sha256=MODEL.sha256
        ),
    )


def ended(last_tick: int, number: int = 1, outcome: Outcome = OUTCOME_SUCCESS) -> Event:
    return Event(
        wall_ns=wall_ns(last_tick),
        room=ROOM,
        tick=last_tick,
        episode_ended=Event.EpisodeEnded(
            number=number, outcome=outcome, ticks=last_tick, reason="the task is done", last_tick=last_tick
        ),
    )


def seats() -> list[Seat]:
    return [
        Seat(arm="arm0", operator=OPERATOR_HUMAN, epoch=3, holder_id="h", name="Ana"),
        Seat(arm="arm1", operator=OPERATOR_HOLD, epoch=4),
    ]


def status(boot: int = BOOT) -> RoomStatus:
    return RoomStatus(room=ROOM, task=TASK, control_hz=20.0, seats=seats(), boot=boot)


def episode_status(
    ticks: int, number: int = 1, phase: EpisodePhase = EPISODE_PHASE_ENDED, outcome: Outcome = OUTCOME_FAILURE
) -> RoomStatus:
    """What the room says again and again of its episode; of one that has ended, how."""
    said = status()
    said.episode.number, said.episode.phase, said.episode.ticks = number, phase, ticks
    if phase == EPISODE_PHASE_ENDED:
        said.episode.outcome, said.episode.reason = outcome, "time is up"
    return said


def video(frame: int, is_key: bool, data: bytes | None = None) -> CompressedVideo:
    """A frame of the toy camera. The data is no decodable picture, but its units have the right types."""
    nal = b"\x00\x00\x00\x01\x67" if is_key else b"\x00\x00\x00\x01\x41"
    sent_ns = wall_ns(0) + frame * 33_000_000
    seconds, nanos = divmod(sent_ns, 1_000_000_000)
    payload = nal + bytes([frame % 251 + 1] * 400) if data is None else data
    return CompressedVideo(
        timestamp=Timestamp(seconds=seconds, nanos=nanos), frame_id="arm0", data=payload, format="h264"
    )


def without(states: Sequence[State], *ticks: int) -> Iterator[State]:
    return (state for state in states if state.tick not in ticks)
