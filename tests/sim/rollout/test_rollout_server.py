"""Worlds stepped by requests."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.batch_state import BatchState, unpack
from mart.protocol.errors import Conflict, InvalidInput, MartError, NotFound, Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest
from mart.protocol.tasks import get_task
from mart.sim.rollout.rollout_server import IDLE_S, MAX_SESSIONS, MAX_WORLDS, RolloutServer
from mart.sim.world import World

TASK = "two_arm_multi_cube_lifting"
SEEDS = (11, 12, 13)


@pytest.fixture(scope="module")
def server() -> RolloutServer:
    return RolloutServer(threads=2)


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def reset(server: RolloutServer, seeds: tuple[int, ...] = SEEDS, now_s: float = 0.0) -> RolloutReply:
    request = RolloutRequest(
        reset=RolloutRequest.Reset(task=TASK, control_hz=20.0, seeds=seeds, integration_states=True)
    )
    return server.answer(request, now_s)


def step(
    server: RolloutServer, session: str, actions: NDArray[np.float64], now_s: float = 0.0
) -> RolloutReply:
    request = RolloutRequest(
        step=RolloutRequest.Step(session=session, actions=actions.astype("<f8").tobytes())
    )
    return server.answer(request, now_s)


def close(server: RolloutServer, session: str, now_s: float = 0.0) -> None:
    server.answer(RolloutRequest(close=RolloutRequest.Close(session=session)), now_s)


def some_actions(ticks: int, worlds: int = len(SEEDS)) -> NDArray[np.float64]:
    return np.random.default_rng(3).uniform(-1, 1, (ticks, worlds, 2, 7))


def worlds_of(reply: RolloutReply) -> BatchState:
    return unpack(get_task(TASK), reply.worlds, len(reply.worlds.failed))


def test_a_batch_goes_as_its_worlds_would_alone(server: RolloutServer, world: World) -> None:
    actions = some_actions(15)
    begun = reset(server)
    stood = [worlds_of(reply) for reply in (begun, *(step(server, begun.session, a) for a in actions))]
    close(server, begun.session)
    for number, seed in enumerate(SEEDS):
        world.reset(seed)
        assert_same(stood[0], number, world)
        for action, worlds in zip(actions, stood[1:], strict=True):
            world.step(action[number])
            assert_same(worlds, number, world)


def assert_same(worlds: BatchState, number: int, world: World) -> None:
    assert worlds.integration_states is not None
    assert worlds.integration_states[number].tobytes() == world.integration_state()
    seen, progress = world.observations(), world.progress()
    assert list(worlds.observations) == list(seen)
    for name, value in seen.items():
        assert worlds.observations[name][number].tobytes() == value.tobytes(), name
    assert worlds.sim_time_s[number] == world.sim_time_s
    assert worlds.subtasks[number].tolist() == list(progress.subtasks.values())
    assert worlds.success_ticks[number] == progress.success_ticks
    assert worlds.success[number] == progress.success
    assert worlds.reasons[number] == (progress.failed or "")


def test_worlds_that_do_not_run_stay_as_they_are(server: RolloutServer) -> None:
    begun = reset(server)
    actions = some_actions(2)
    first, both = (step_some(server, begun.session, action, running=[1, 0, 1]) for action in actions)
    last = worlds_of(step(server, begun.session, actions[0]))
    close(server, begun.session)
    alone = reset(server)
    all_run = [worlds_of(step(server, alone.session, action)) for action in actions]
    close(server, alone.session)
    for stopped in (first, both):
        assert states(stopped)[1] == states(worlds_of(begun))[1]
    assert states(first)[::2] == states(all_run[0])[::2]
    assert states(both)[::2] == states(all_run[1])[::2]
    assert states(last)[1] == states(all_run[0])[1]


def test_a_step_that_comes_again_is_only_answered(server: RolloutServer) -> None:
    session, actions = reset(server).session, some_actions(2)

    def numbered(number: int) -> RolloutReply:
        payload = actions[number - 1].tobytes()
        message = RolloutRequest.Step(session=session, actions=payload, number=number)
        return server.answer(RolloutRequest(step=message), 0.0)

    first = numbered(1)
    assert numbered(1) == first
    second = numbered(2)
    assert second != first
    assert numbered(2) == second
    with pytest.raises(Conflict):
        numbered(1)
    close(server, session)


def step_some(
    server: RolloutServer, session: str, actions: NDArray[np.float64], running: list[int]
) -> BatchState:
    message = RolloutRequest.Step(session=session, actions=actions.tobytes(), running=bytes(running))
    return worlds_of(server.answer(RolloutRequest(step=message), 0.0))


def states(worlds: BatchState) -> list[bytes]:
    assert worlds.integration_states is not None
    return [state.tobytes() for state in worlds.integration_states]


def test_states_travel_only_where_asked_for(server: RolloutServer) -> None:
    request = RolloutRequest(reset=RolloutRequest.Reset(task=TASK, control_hz=20.0, seeds=SEEDS))
    begun = server.answer(request, 0.0)
    stepped = step(server, begun.session, some_actions(1)[0])
    close(server, begun.session)
    assert worlds_of(begun).integration_states is None
    assert worlds_of(stepped).integration_states is None


def test_sessions_do_not_disturb_each_other(server: RolloutServer) -> None:
    actions = some_actions(4)
    alone = reset(server)
    expected = [step(server, alone.session, action).worlds for action in actions]
    one, other = reset(server), reset(server, (99,))
    for action, worlds in zip(actions, expected, strict=True):
        step(server, other.session, action[:1])
        assert step(server, one.session, action).worlds == worlds
    for reply in (alone, one, other):
        close(server, reply.session)


def test_a_resimulation_digests_every_state(server: RolloutServer, world: World) -> None:
    actions = some_actions(10, worlds=1)[:, 0]
    world.reset(4)
    first = world.integration_state()
    expected = b""
    for action in actions:
        world.step(action)
        expected += hashlib.blake2b(world.integration_state(), digest_size=16).digest()
    request = resimulation(world, first, actions)
    assert server.answer(request, 0.0).state_digests == expected


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


def test_a_recording_of_another_model_is_a_conflict(server: RolloutServer, world: World) -> None:
    world.reset(4)
    request = resimulation(world, world.integration_state(), some_actions(1, worlds=1)[:, 0])
    request.resimulate.model_sha256 = "0" * 64
    with pytest.raises(Conflict):
        server.answer(request, 0.0)


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
    server: RolloutServer, request_: RolloutRequest, error: type[MartError]
) -> None:
    with pytest.raises(error):
        server.answer(request_, 0.0)


@pytest.mark.parametrize(
    "actions",
    [
        np.zeros((2, 2, 7)),
        np.zeros((3, 2, 6)),
        np.full((3, 2, 7), np.nan),
        np.full((3, 2, 7), np.inf),
        np.full((3, 2, 7), -1.01),
    ],
)
def test_bad_actions_are_refused_and_nothing_moves(
    server: RolloutServer, actions: NDArray[np.float64]
) -> None:
    begun = reset(server)
    good = some_actions(1)[0]
    expected = step(server, begun.session, good).worlds
    again = reset(server)
    with pytest.raises(InvalidInput):
        step(server, again.session, actions)
    assert step(server, again.session, good).worlds == expected
    for reply in (begun, again):
        close(server, reply.session)


def test_sessions_are_bounded_and_idle_ones_make_room(server: RolloutServer) -> None:
    sessions = [reset(server, (1,)).session for _ in range(MAX_SESSIONS)]
    with pytest.raises(Unavailable):
        reset(server, (1,), now_s=1.0)
    later_s = IDLE_S + 1.0
    kept = reset(server, (1,), now_s=later_s).session
    with pytest.raises(NotFound):
        close(server, sessions[0], later_s)
    close(server, kept, later_s)


def test_a_session_that_is_used_is_kept(server: RolloutServer) -> None:
    session = reset(server, (1,)).session
    numbered = RolloutRequest.Step(session=session, actions=some_actions(1)[0][:1].tobytes())
    for later_s in (0.6 * IDLE_S, 1.2 * IDLE_S, 1.8 * IDLE_S):
        server.answer(RolloutRequest(step=numbered), later_s)
    close(server, session, 1.8 * IDLE_S)


def test_worlds_are_bounded_over_all_sessions(server: RolloutServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.sim.rollout.rollout_server.MAX_WORLDS", 4)
    held = reset(server)
    with pytest.raises(Unavailable):
        reset(server, (1, 2))
    step(server, held.session, some_actions(1)[0])
    close(server, held.session)
    close(server, reset(server, (1, 2)).session)


def test_a_session_of_an_earlier_run_is_told_from_one_that_was_closed(server: RolloutServer) -> None:
    session = reset(server, (1,)).session
    close(server, session)
    with pytest.raises(NotFound, match="closed, or idle"):
        close(server, session)
    with pytest.raises(NotFound, match="restarted"):
        close(RolloutServer(threads=1), session)
