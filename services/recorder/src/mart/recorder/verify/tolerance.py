"""Tell how far re-simulation is from a recording one tick ahead of each recorded state, so that nothing adds up.

Contacts make what differs in the last bit differ visibly within a second, so a comparison of whole episodes says
nothing about sizes. From a recorded state to the next, another processor's rounding stays small.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt
from mart.protocol.messages import RolloutRequest, State
from mart.protocol.recording import RoomRecord
from mart.recorder.verify.replica import AskReplica
from mart.recorder.verify.stretches import own_task_of, stretches

# What one tick may differ by on another processor, in metres and radians, and those a second: measured, with room; see
# docs/decisions/0034-what-another-processor-may-differ-by.md. Other parts of the state are told and not judged: a warm
# start is an acceleration, and controls are torques.
BOUNDS: Mapping[str, float] = MappingProxyType({"positions": 2e-3, "velocities": 0.2})
_TICKS_A_REQUEST = 100
_MAX_STATE_BYTES = 256 * 1024


@dataclass(frozen=True)
class Difference:
    """Hold the largest difference of one part of the state, and the tick of the recorded state that it is from."""

    largest: float
    tick: int


@dataclass(frozen=True)
class Comparison:
    """Hold by how much each part of the state differs at most, one tick ahead."""

    differences: Mapping[str, Difference]

    @property
    def within_tolerance(self) -> bool:
        """Whether positions and velocities stay within `BOUNDS`."""
        return all(self.differences[name].largest <= most for name, most in BOUNDS.items())

    def __str__(self) -> str:
        worst = ", ".join(
            f"{self.differences[name].largest:.1e} in {name} (tick {self.differences[name].tick}; bound {most:g})"
            for name, most in BOUNDS.items()
        )
        return f"One tick ahead of each recorded state it differs by at most {worst}."


def compare_ticks(file: EpisodeFile, room: RoomRecord, ask: AskReplica, *, native: bool) -> Comparison:
    """Step each recorded state of a file one tick ahead and compare.

    Raises Corrupt where the file cannot be stepped, or what the replica says where it cannot answer.
    """
    worst: dict[str, Difference] = {}
    own = own_task_of(file, room)
    for stretch in stretches(_bounded(file.states()), _TICKS_A_REQUEST, with_states=True):
        if not stretch.digests:
            continue
        request = RolloutRequest.CompareTicks(
            model_sha256=room.model_sha256 or "",
            task=room.task or "",
            control_hz=room.control_hz or 0.0,
            arms=len(stretch.arms),
            arm_kinds=room.arm_kinds,
            states=b"".join(stretch.states or ()),
            actions=stretch.packed_actions(),
            native=native,
            task_file=own.task_file if own else b"",
            mjb=own.mjb if own else b"",
        )
        for told in ask(RolloutRequest(compare_ticks=request)).differences:
            one = Difference(told.largest, stretch.first_tick + told.transition + 1)
            if told.group not in worst or one.largest > worst[told.group].largest:
                worst[told.group] = one
    if not BOUNDS.keys() <= worst.keys():
        raise Corrupt("The replica did not tell by how much positions and velocities differ.")
    return Comparison(worst)


def _bounded(states: Iterator[State]) -> Iterator[State]:
    for state in states:
        if len(state.integration_state) > _MAX_STATE_BYTES:
            raise Corrupt(f"The state of tick {state.tick} has {len(state.integration_state)} bytes.")
        yield state
