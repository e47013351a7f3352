"""Worlds stepped by requests."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.errors import Conflict, InvalidInput, MartError, NotFound, Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest
from mart.sim.lockstep import IDLE_S, MAX_SESSIONS, MAX_WORLDS, Lockstep
from mart.sim.world import Diverged, World

TASK = "two_arm_multi_cube_lifting"
SEEDS = (11, 12, 13)


@pytest.fixture(scope="module")
def lockstep() -> Iterator[Lockstep]:
    lockstep = Lockstep(workers=2)
    yield lockstep
    lockstep.close()


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def reset(lockstep: Lockstep, seeds: tuple[int, ...] = SEEDS, now_s: float = 0.0) -> RolloutReply:
    request = RolloutRequest(reset=RolloutRequest.Reset(task=TASK, control_hz=20.0, seeds=seeds))
    return lockstep.answer(request, now_s)


def step(lockstep: Lockstep, session: str, actions: NDArray[np.float64], now_s: float = 0.0) -> RolloutReply:
    request = RolloutRequest(
        step=RolloutRequest.Step(session=session, actions=actions.astype("<f8").tobytes())
    )
    return lockstep.answer(request, now_s)


def close(lockstep: Lockstep, session: str, now_s: float = 0.0) -> None:
    lockstep.answer(RolloutRequest(close=RolloutRequest.Close(session=session)), now_s)


def some_actions(ticks: int, worlds: int = len(SEEDS)) -> NDArray[np.float64]:
    return np.random.default_rng(3).uniform(-1, 1, (ticks, worlds, 2, 7))


def test_a_batch_goes_as_its_worlds_would_alone(lockstep: Lockstep, world: World) -> None:
    actions = some_actions(15)
    begun = reset(lockstep)
    replies = [step(lockstep, begun.session, action) for action in actions]
    close(lockstep, begun.session)
    for number, seed in enumerate(SEEDS):
        world.reset(seed)
        assert begun.worlds[number].integration_state == world.integration_state()
        for action, reply in zip(actions, replies, strict=True):
            world.step(action[number])
            stepped = reply.worlds[number]
            assert stepped.integration_state == world.integration_state()
            assert {seen.name: list(seen.value) for seen in stepped.observations} == {
                name: value.tolist() for name, value in world.observations().items()
            }
            assert stepped.sim_time_s == world.sim_time_s
            assert stepped.progress.success_ticks == world.progress().success_ticks


def test_sessions_do_not_disturb_each_other(lockstep: Lockstep) -> None:
    actions = some_actions(4)
    alone = reset(lockstep)
    expected = [step(lockstep, alone.session, action).worlds for action in actions]
    one, other = reset(lockstep), reset(lockstep, (99,))
    for action, worlds in zip(actions, expected, strict=True):
        step(lockstep, other.session, action[:1])
        assert step(lockstep, one.session, action).worlds == worlds
    for reply in (alone, one, other):
        close(lockstep, reply.session)


def test_a_resimulation_digests_every_state(lockstep: Lockstep, world: World) -> None:
    actions = some_actions(10, worlds=1)[:, 0]
    world.reset(4)
    first = world.integration_state()
    expected = b""
    for action in actions:
        world.step(action)
        expected += hashlib.blake2b(world.integration_state(), digest_size=16).digest()
    request = resimulation(world, first, actions)
    assert lockstep.answer(request, 0.0).state_digests == expected


def resimulation(world: World, first_state: bytes, actions: NDArray[np.float64]) -> RolloutRequest:
    return RolloutRequest(
        resimulate=RolloutRequest.Resimulate(
            model_sha256=world.model_sha256,
            task=TASK,
            control_hz=20.0,
            first_state=first_state,
            actions=actions.astype("<f8").tobytes(),
        )
    )


def test_a_recording_of_another_model_is_a_conflict(lockstep: Lockstep, world: World) -> None:
    world.reset(4)
    request = resimulation(world, world.integration_state(), some_actions(1, worlds=1)[:, 0])
    request.resimulate.model_sha256 = "0" * 64
    with pytest.raises(Conflict, match="000000"):
        lockstep.answer(request, 0.0)


def test_a_world_that_diverges_stays_and_the_others_go_on(
    lockstep: Lockstep, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = reset(lockstep)
    honest_step = World.step

    def diverge_on_request(world: World, action: NDArray[np.float64]) -> None:
        if action[0, 0] == 0.5:
            raise Diverged(world.sim_time_s)
        honest_step(world, action)

    actions = np.zeros((3, 2, 7))
    actions[1, 0, 0] = 0.5
    with monkeypatch.context() as broken:
        broken.setattr(World, "step", diverge_on_request)
        worlds = step(lockstep, begun.session, actions).worlds
    assert [bool(world.progress.failed) for world in worlds] == [False, True, False]
    assert worlds[1].integration_state == begun.worlds[1].integration_state
    assert worlds[0].integration_state != begun.worlds[0].integration_state
    close(lockstep, begun.session)


@pytest.mark.parametrize(
    ("request_", "error"),
    [
        (RolloutRequest(), InvalidInput),
        (RolloutRequest(reset=RolloutRequest.Reset(task="juggling", control_hz=20.0, seeds=[1])), NotFound),
        (RolloutRequest(reset=RolloutRequest.Reset(task=TASK, control_hz=0.0, seeds=[1])), InvalidInput),
        (
            RolloutRequest(reset=RolloutRequest.Reset(task=TASK, control_hz=20.0, arms=9, seeds=[1])),
            InvalidInput,
        ),
        (RolloutRequest(reset=RolloutRequest.Reset(task=TASK, control_hz=20.0)), InvalidInput),
        (
            RolloutRequest(
                reset=RolloutRequest.Reset(task=TASK, control_hz=20.0, seeds=[1] * (MAX_WORLDS + 1))
            ),
            InvalidInput,
        ),
        (RolloutRequest(step=RolloutRequest.Step(session="gone")), NotFound),
        (RolloutRequest(close=RolloutRequest.Close(session="gone")), NotFound),
    ],
)
def test_bad_requests_are_refused(
    lockstep: Lockstep, request_: RolloutRequest, error: type[MartError]
) -> None:
    with pytest.raises(error):
        lockstep.answer(request_, 0.0)


@pytest.mark.parametrize(
    "actions",
    [np.zeros((2, 2, 7)), np.zeros((3, 2, 6)), np.full((3, 2, 7), np.nan), np.full((3, 2, 7), np.inf)],
)
def test_bad_actions_are_refused_and_nothing_moves(lockstep: Lockstep, actions: NDArray[np.float64]) -> None:
    begun = reset(lockstep)
    good = some_actions(1)[0]
    expected = step(lockstep, begun.session, good).worlds
    again = reset(lockstep)
    with pytest.raises(InvalidInput):
        step(lockstep, again.session, actions)
    assert step(lockstep, again.session, good).worlds == expected
    for reply in (begun, again):
        close(lockstep, reply.session)


def test_sessions_are_bounded_and_idle_ones_make_room(lockstep: Lockstep) -> None:
    sessions = [reset(lockstep, (1,)).session for _ in range(MAX_SESSIONS)]
    with pytest.raises(Unavailable):
        reset(lockstep, (1,), now_s=1.0)
    later_s = IDLE_S + 1.0
    kept = reset(lockstep, (1,), now_s=later_s).session
    with pytest.raises(NotFound):
        close(lockstep, sessions[0], later_s)
    close(lockstep, kept, later_s)
