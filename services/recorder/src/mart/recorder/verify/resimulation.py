"""Tell whether a file's ticks follow from each other: re-simulated by a replica, compared bit for bit.

From the first state on, the applied actions of each tick are stepped again in the same world, and a digest of every
integration state is compared with the recorded one. A stretch ends where ticks are missing, and after `_STRETCH_TICKS`,
so that a request stays small; each begins at a recorded state.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, keys
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Corrupt, MartError, Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest, State, raise_error
from mart.protocol.received import decode_received
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.state_digest import DIGEST_BYTES, state_digest
from mart.protocol.vocabulary import ServiceKind, Verdict
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus import Bus

_STRETCH_TICKS = 2000
_TIMEOUT_S = 20.0
_TIMEOUT_PER_TICK_S = 0.02
_PATIENCE_S = 5.0

Resimulate = Callable[[RolloutRequest.Resimulate], bytes]


@dataclass
class Stretch:
    """Hold ticks without a gap: where they begin and what each one applied and led to."""

    first_tick: int
    first_state: bytes
    arms: tuple[str, ...]
    actions: list[list[float]] = field(default_factory=list)
    digests: list[bytes] = field(default_factory=list)

    @property
    def last_tick(self) -> int:
        """The tick of the last state that was added."""
        return self.first_tick + len(self.digests)

    def add(self, state: State) -> None:
        """Add the state that follows."""
        self.actions.append([number for arm in state.arms for number in arm.action])
        self.digests.append(state_digest(state.integration_state))

    def request(self, room: RoomRecord) -> RolloutRequest.Resimulate:
        """Return what a replica is asked. Raises Corrupt where an action is not of seven finite numbers an arm."""
        shape = (len(self.actions), len(self.arms), ACTION_SIZE)
        if {len(action) for action in self.actions} - {ACTION_SIZE * len(self.arms)}:
            raise Corrupt(
                f"After tick {self.first_tick} an applied action has not {ACTION_SIZE} numbers for each arm."
            )
        actions = np.array(self.actions, dtype="<f8").reshape(shape)
        if not np.isfinite(actions).all():
            raise Corrupt(f"After tick {self.first_tick} an applied action is not finite.")
        return RolloutRequest.Resimulate(
            model_sha256=room.model_sha256 or "",
            task=room.task or "",
            control_hz=room.control_hz or 0.0,
            arms=len(self.arms),
            first_state=self.first_state,
            actions=actions.tobytes(),
        )


def stretches(states: Iterator[State], most_ticks: int = _STRETCH_TICKS) -> Iterator[Stretch]:
    """Cut an episode's states where ticks are missing and where a stretch gets longer than `most_ticks`."""
    current: Stretch | None = None
    previous: State | None = None
    for state in states:
        arms = tuple(arm.arm for arm in state.arms)
        if current is not None and previous is not None:
            follows = state.tick == current.last_tick + 1 and arms == current.arms
            if not follows or len(current.digests) >= most_ticks:
                yield current
                current = _begin(previous) if follows else None
        if current is None:
            current = _begin(state)
        else:
            current.add(state)
        previous = state
    if current is not None:
        yield current


def _begin(state: State) -> Stretch:
    return Stretch(state.tick, state.integration_state, tuple(arm.arm for arm in state.arms))


def verify(file: EpisodeFile, room: RoomRecord, resimulate: Resimulate) -> VerificationRecord:
    """Step a file again and return the verdict. Never raises for what it finds: a doubt is a verdict."""
    try:
        verdict, detail = _judge(file, room, resimulate)
    except MartError as error:
        verdict, detail = Verdict.UNVERIFIED, str(error)
    return VerificationRecord(
        verdict=verdict, detail=detail, model_sha256=room.model_sha256, mujoco_version=room.mujoco_version
    )


@dataclass(frozen=True)
class ComparedStretch:
    """Tell of one stretch that was stepped again which of its ticks led elsewhere."""

    first_tick: int
    last_tick: int
    different: tuple[int, ...]


def compare(file: EpisodeFile, room: RoomRecord, resimulate: Resimulate) -> Iterator[ComparedStretch]:
    """Step every stretch of a file again. Raises Corrupt, or what the replica says where it cannot answer."""
    if not (room.task and room.control_hz and room.model_sha256):
        raise Corrupt(
            f"{file.path} does not say its task, its rate and its model; it cannot be stepped again."
        )
    EpisodeFile(file.path, {RoomRecord.NAME: room.to_strings()}).check_model()
    for stretch in stretches(file.states()):
        answered = resimulate(stretch.request(room)) if stretch.digests else b""
        if len(answered) != DIGEST_BYTES * len(stretch.digests):
            raise Corrupt(f"The replica answered {len(answered)} bytes for {len(stretch.digests)} ticks.")
        again = [answered[i : i + DIGEST_BYTES] for i in range(0, len(answered), DIGEST_BYTES)]
        pairs = enumerate(zip(stretch.digests, again, strict=True), stretch.first_tick + 1)
        yield ComparedStretch(
            stretch.first_tick, stretch.last_tick, tuple(tick for tick, (a, b) in pairs if a != b)
        )


def _judge(file: EpisodeFile, room: RoomRecord, resimulate: Resimulate) -> tuple[Verdict, str]:
    checked, gaps, last_tick = 0, list[str](), None
    for stretch in compare(file, room, resimulate):
        if stretch.different:
            return Verdict.DIVERGED, f"Re-simulation differs from tick {stretch.different[0]} on."
        if last_tick not in (None, stretch.first_tick):
            gaps.append(f"{last_tick} to {stretch.first_tick}")
        last_tick = stretch.last_tick
        checked += stretch.last_tick - stretch.first_tick
    if not checked:
        return Verdict.UNVERIFIED, "It holds no tick that follows from another."
    if gaps:
        return (
            Verdict.UNVERIFIED,
            f"{checked} ticks re-simulated bit for bit; not those from {', '.join(gaps[:8])}.",
        )
    return Verdict.VERIFIED, f"{checked} ticks re-simulated bit for bit."


def replica(bus: Bus, name: str, patience_s: float = _PATIENCE_S) -> Resimulate:
    """Ask the replica called `name`. Raises Unavailable, at once where there was none, or where it does not answer.

    One that was there is awaited for `patience_s`: a router that is started anew forgets for about 2 s who is alive.
    """
    token = keys.alive(ServiceKind.REPLICA, name)
    was_up = False

    def resimulate(request: RolloutRequest.Resimulate) -> bytes:
        nonlocal was_up
        is_up = token in await_alive(bus, token, {token}, patience_s) if was_up else bool(bus.alive(token))
        was_up = is_up
        if not is_up:
            raise Unavailable(f"No replica {name!r} is up; start one with `mart replica --name {name}`.")
        ticks = len(request.actions) // (8 * ACTION_SIZE * max(request.arms, 1))
        payload = codec.encode(RolloutRequest(resimulate=request))
        answer = bus.query(keys.rollout(name), payload, _TIMEOUT_S + _TIMEOUT_PER_TICK_S * ticks)
        reply = decode_received(RolloutReply, answer)
        raise_error(reply.error)
        return reply.state_digests

    return resimulate


def nobody(why: MartError) -> Resimulate:
    """Stand in where no replica can be asked: the function raises why."""

    def resimulate(_request: RolloutRequest.Resimulate) -> bytes:
        raise why

    return resimulate
