"""Cut an episode where ticks are missing: what lies between can be stepped again, in requests of a bounded size."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from mart.episodes.reader import EpisodeFile
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Corrupt
from mart.protocol.messages import RolloutRequest, State
from mart.protocol.recording import RoomRecord
from mart.protocol.state_digest import state_digest
from mart.protocol.tasks import is_in_catalogue

_STRETCH_TICKS = 2000


@dataclass(frozen=True)
class OwnTask:
    """Hold what a replica needs to step a task that is somebody's own: its task file and its compiled model."""

    task_file: bytes
    mjb: bytes


def own_task_of(file: EpisodeFile, room: RoomRecord) -> OwnTask | None:
    """Return what a file carries of a task that is somebody's own, None where the catalogue has the task."""
    text = None if is_in_catalogue(room.task or "") else file.task_file()
    if text is None:
        return None
    return OwnTask(text, EpisodeFile(file.path, {RoomRecord.NAME: room.to_strings()}).model())


@dataclass
class Stretch:
    """Hold ticks without a gap: where they begin and what each one applied and led to.

    states: every state, the first included, where they are wanted.
    """

    first_tick: int
    first_state: bytes
    arms: tuple[str, ...]
    actions: list[list[float]] = field(default_factory=list)
    digests: list[bytes] = field(default_factory=list)
    states: list[bytes] | None = None

    @property
    def last_tick(self) -> int:
        """The tick of the last state that was added."""
        return self.first_tick + len(self.digests)

    def add(self, state: State) -> None:
        """Add the state that follows."""
        self.actions.append([number for arm in state.arms for number in arm.action])
        self.digests.append(state_digest(state.integration_state))
        if self.states is not None:
            self.states.append(state.integration_state)

    def request(
        self, room: RoomRecord, own: OwnTask | None = None, *, native: bool = False
    ) -> RolloutRequest.Resimulate:
        """Return what a replica is asked to step again. Raises Corrupt as `packed_actions` does."""
        return RolloutRequest.Resimulate(
            model_sha256=room.model_sha256 or "",
            task=room.task or "",
            control_hz=room.control_hz or 0.0,
            arms=len(self.arms),
            arm_kinds=room.arm_kinds,
            first_state=self.first_state,
            actions=self.packed_actions(),
            native=native,
            task_file=own.task_file if own else b"",
            mjb=own.mjb if own else b"",
        )

    def packed_actions(self) -> bytes:
        """Return every action, float64, shape (ticks, arms, 7).

        Raises Corrupt where an action is not of seven finite numbers an arm.
        """
        shape = (len(self.actions), len(self.arms), ACTION_SIZE)
        if {len(action) for action in self.actions} - {ACTION_SIZE * len(self.arms)}:
            raise Corrupt(
                f"After tick {self.first_tick} an applied action has not {ACTION_SIZE} numbers for each arm."
            )
        actions = np.array(self.actions, dtype="<f8").reshape(shape)
        if not np.isfinite(actions).all():
            raise Corrupt(f"After tick {self.first_tick} an applied action is not finite.")
        return actions.tobytes()


def stretches(
    states: Iterator[State], most_ticks: int = _STRETCH_TICKS, *, with_states: bool = False
) -> Iterator[Stretch]:
    """Cut an episode's states where ticks are missing and where a stretch gets longer than `most_ticks`."""
    current: Stretch | None = None
    previous: State | None = None
    for state in states:
        arms = tuple(arm.arm for arm in state.arms)
        if current is not None and previous is not None:
            follows = state.tick == current.last_tick + 1 and arms == current.arms
            if not follows or len(current.digests) >= most_ticks:
                yield current
                current = _begin(previous, with_states=with_states) if follows else None
        if current is None:
            current = _begin(state, with_states=with_states)
        else:
            current.add(state)
        previous = state
    if current is not None:
        yield current


def _begin(state: State, *, with_states: bool) -> Stretch:
    arms = tuple(arm.arm for arm in state.arms)
    kept = [state.integration_state] if with_states else None
    return Stretch(state.tick, state.integration_state, arms, states=kept)
