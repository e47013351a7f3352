"""Recordings are stepped again: from one state on, and each recorded state one tick ahead."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.errors import Conflict, InvalidInput, MartError
from mart.protocol.messages import Numerics, RolloutReply, RolloutRequest
from mart.sim.rollout.compiled_worlds import MAX_COMPILED, CompiledWorlds, WorldSpec
from mart.sim.rollout.resimulation import FAR, Resimulator, differences_of
from mart.sim.world import World
from mart.sim.world.numerics import own_numerics

TASK = "two_arm_multi_cube_lifting"
TICKS = 6


class Recording:
    """Some ticks of a real world."""

    def __init__(self) -> None:
        self.world = World.build(TASK)
        self.world.reset(5)
        self.actions = np.random.default_rng(2).uniform(-1, 1, (TICKS, 2, 7))
        self.states = [self.world.integration_state()]
        for action in self.actions:
            self.world.step(action)
            self.states.append(self.world.integration_state())

    def compare_ticks(self, states: list[bytes], *, native: bool = False) -> RolloutRequest.CompareTicks:
        return RolloutRequest.CompareTicks(
            model_sha256=self.world.model_sha256,
            task=TASK,
            control_hz=20.0,
            arms=2,
            states=b"".join(states),
            actions=self.actions.astype("<f8").tobytes(),
            native=native,
        )


@pytest.fixture(scope="module")
def recording() -> Recording:
    return Recording()


@pytest.fixture(scope="module")
def resimulator() -> Resimulator:
    return Resimulator(CompiledWorlds())


def shifted(state: bytes, index: int, by: float) -> bytes:
    numbers: NDArray[np.float64] = np.frombuffer(state, "<f8").copy()
    numbers[index] += by
    return numbers.tobytes()


def test_what_follows_differs_by_nothing(recording: Recording, resimulator: Resimulator) -> None:
    reply = resimulator.compare(recording.compare_ticks(recording.states))
    told = {one.group: one.largest for one in reply.differences}
    assert {"time", "positions", "velocities", "warm_start", "controls", "memory"} <= told.keys()
    assert set(told.values()) == {0.0}
    assert reply.numerics == own_numerics()


def test_the_largest_difference_of_each_part_is_told_with_where_it_is(
    recording: Recording, resimulator: Resimulator
) -> None:
    states = [
        *recording.states[:-1],
        shifted(recording.states[-1], 1, 1e-3),
    ]  # the first position after the time
    reply = resimulator.compare(recording.compare_ticks(states))
    told = {one.group: (one.largest, one.transition) for one in reply.differences}
    assert told["positions"][0] == pytest.approx(1e-3)
    assert told["positions"][1] == TICKS - 1
    assert told["velocities"] == (0.0, 0)


def test_what_is_no_number_differs_by_more_than_any_world(recording: Recording) -> None:
    recorded = np.frombuffer(recording.states[0], "<f8")[None]
    again = recorded.copy()
    again[0, 0] = np.nan
    told = {one.group: one.largest for one in differences_of(recording.world.model, recorded, again)}
    assert (told["time"], told["positions"]) == (FAR, 0.0)


@pytest.mark.parametrize(
    ("other", "error"),
    [
        ({"model_sha256": "0" * 64}, Conflict),
        ({"states": b"short"}, InvalidInput),
        ({"arms": 9}, InvalidInput),
    ],
)
def test_what_cannot_be_compared_is_refused(
    recording: Recording, resimulator: Resimulator, other: dict[str, object], error: type[MartError]
) -> None:
    request = recording.compare_ticks(recording.states)
    for name, value in other.items():
        setattr(request, name, value)
    with pytest.raises(error):
        resimulator.compare(request)


class Elsewhere:
    """A process that computes otherwise."""

    def __init__(self, *, is_needed: bool) -> None:
        self.is_needed = is_needed

    def ask(self, request: RolloutRequest) -> RolloutReply:
        return RolloutReply(session=str(request.WhichOneof("what")), numerics=Numerics(fingerprint="native"))


@pytest.mark.parametrize("is_needed", [False, True])
def test_what_is_asked_natively_is_answered_by_a_process_that_computes_so(
    recording: Recording, *, is_needed: bool
) -> None:
    resimulator = Resimulator(CompiledWorlds(), Elsewhere(is_needed=is_needed))
    reply = resimulator.compare(recording.compare_ticks(recording.states, native=True))
    assert reply.numerics.fingerprint == ("native" if is_needed else own_numerics().fingerprint)
    assert resimulator.compare(recording.compare_ticks(recording.states)).numerics == own_numerics()


def test_only_the_worlds_of_late_are_kept() -> None:
    worlds = CompiledWorlds()
    specs = [WorldSpec(TASK, float(20 + i), None) for i in range(MAX_COMPILED + 1)]
    first = worlds.get(specs[0])
    for spec in specs[1:-1]:
        worlds.get(spec)
    assert worlds.get(specs[0]) is first
    second = worlds.get(specs[1])
    for spec in (specs[0], *specs[2:]):
        worlds.get(spec)
    assert worlds.get(specs[0]) is first
    assert worlds.get(specs[1]) is not second
