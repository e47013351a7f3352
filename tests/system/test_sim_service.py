"""The sim as a process: a router, a room, scripted operators, and whoever asks."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import (
    BARRIER_PHASE_STALLED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    OUTCOME_SUCCESS,
    Command,
    EpisodeRequest,
    RolloutReply,
    RolloutRequest,
    Seat,
    State,
)
from tests.support.processes import Running, running_router, running_service, started
from tests.system.room_client import Driver, RoomClient

ROOM = "room-1"


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    with running_router() as endpoint:
        yield endpoint


@pytest.fixture
def sim(endpoint: str, tmp_path: Path) -> Iterator[Running]:
    with running_sim(endpoint, tmp_path) as running:
        yield running


def running_sim(endpoint: str, data_dir: Path) -> AbstractContextManager[Running]:
    return running_service(
        ["sim", "--room", ROOM, "--seed", "1", "--control-hz", "20"], endpoint, data_dir, kind="sim", id=ROOM
    )


@pytest.fixture
def client(endpoint: str, sim: Running) -> Iterator[RoomClient]:
    with RoomClient(endpoint, ROOM) as client:
        client.states.wait_for(lambda _: True)  # the room has been heard
        yield client


def two_drivers(client: RoomClient) -> tuple[Driver, Driver]:
    first, second = (client.driver(client.claim(arm, f"holder-of-{arm}").seat) for arm in ("arm0", "arm1"))
    return first, second


def used(state: State) -> tuple[int, ...]:
    return tuple(arm.sequence for arm in state.arms)


def test_the_world_advances_only_with_every_command(client: RoomClient) -> None:
    first, second = two_drivers(client)
    for _ in range(5):
        first.give()
        second.give()
        state = client.states.wait_for(lambda state: used(state) == (first.sequence, second.sequence))
        assert all(arm.fresh for arm in state.arms)
        assert state.stamps.due_ns <= state.stamps.fired_ns <= state.stamps.stepped_ns <= state.stamps.sent_ns
    lone = first.give()
    client.statuses.wait_for(
        lambda status: (
            status.barrier == BARRIER_PHASE_STALLED and [w.arm for w in status.waiting_for] == ["arm1"]
        )
    )
    assert not any(state.arms[0].sequence == lone for state in client.states.all())


def test_a_command_of_an_earlier_holder_is_ignored(client: RoomClient) -> None:
    first, second = two_drivers(client)
    stranger = client.driver(Seat(arm="arm0", epoch=first.epoch - 1))
    stranger.sequence = 1000
    stranger.give()
    second.give()
    client.statuses.wait_for(lambda status: status.rejected_commands == 1)
    sequence = first.give()
    state = client.states.wait_for(lambda state: all(arm.fresh for arm in state.arms))
    assert state.arms[0].sequence == sequence


def test_garbage_on_every_key_disturbs_nobody(client: RoomClient, sim: Running) -> None:
    first, second = two_drivers(client)
    garbage = b"\xff\x00garbage"
    for topic in (keys.command(ROOM, "arm9"), keys.intent(ROOM, "arm0"), keys.event(ROOM)):
        client.bus.publisher(topic).put(garbage)
    for payload in (garbage, b"", bytes(5000), codec.encode(Command(arm="arm0", gripper=float("nan")))):
        first.give_bytes(payload)
    for topic in (keys.seat(ROOM), keys.episode(ROOM)):
        reply = client.bus.query(topic, garbage, timeout_s=10)
        assert b"InvalidInput" in reply
    client.statuses.wait_for(lambda status: status.rejected_commands == 5)
    client.tick(first, second)
    assert "Traceback" not in sim.log()
    assert "Not used: " in sim.log()


def test_a_flood_disturbs_nobody(client: RoomClient) -> None:
    first, second = two_drivers(client)
    for _ in range(5):
        for _ in range(2000):
            first.give_bytes(b"\xff\x00garbage")
        assert all(arm.fresh for arm in client.tick(first, second).arms)


def test_a_second_claim_is_a_conflict(client: RoomClient) -> None:
    assert client.claim("arm0", "ana", "Ana").seat.name == "Ana"
    reply = client.claim("arm0", "ben", "Ben")
    assert reply.error.code == "Conflict"
    assert "Ana" in reply.error.message
    assert reply.status.seats[0].name == "Ana"
    again = client.claim("arm0", "ana", "Ana")
    assert again.seat == reply.status.seats[0]


def test_what_does_not_exist_is_named(client: RoomClient, endpoint: str, tmp_path: Path) -> None:
    reply = client.claim("arm7", "ana")
    assert (reply.error.code, "arm0, arm1" in reply.error.message) == ("NotFound", True)
    with pytest.raises(Unavailable, match="room-9"):
        client.bus.query(keys.seat("room-9"), b"", timeout_s=1)
    for options, words in (
        (["--task", "two_arm_multi_cube_liftin"], "Did you mean 'two_arm_multi_cube_lifting'?"),
        (["--arms", "7"], "7 arms were asked for"),
        (["--room", "Room 1"], "lower-case"),
    ):
        with started(["sim", *options], endpoint, tmp_path) as refused:
            assert refused.process.wait(30) == 1
            assert words in refused.log()
            assert "Traceback" not in refused.log()


def test_the_model_is_served(client: RoomClient) -> None:
    model = client.model()
    assert model.sha256 == hashlib.sha256(model.mjb).hexdigest()
    assert (model.task, list(model.arms)) == ("two_arm_multi_cube_lifting", ["arm0", "arm1"])


def test_a_killed_sim_comes_back_with_its_seats(endpoint: str, tmp_path: Path) -> None:
    with RoomClient(endpoint, ROOM) as client:
        with running_sim(endpoint, tmp_path) as sim:
            first = client.driver(client.claim("arm0", "ana", "Ana").seat)
            client.assign("arm1", OPERATOR_SCRIPT)
            client.statuses.wait_for(lambda status: status.seats[1].operator == OPERATOR_SCRIPT)
            before = client.statuses.all()[-1]
            sim.kill()
        with running_sim(endpoint, tmp_path):
            after = client.statuses.wait_for(lambda status: status.boot != before.boot)
            assert [(seat.operator, seat.epoch, seat.name) for seat in after.seats] == [
                (OPERATOR_HUMAN, 2, "Ana"),
                (OPERATOR_SCRIPT, 2, ""),
            ]
            client.assign("arm1", OPERATOR_HOLD)
            assert client.tick(first).boot == after.boot


def test_two_scripts_lift_the_cubes_and_the_episode_replays(
    client: RoomClient, endpoint: str, tmp_path: Path
) -> None:
    with (
        running_service(["experts"], endpoint, tmp_path, kind="experts", id="experts"),
        running_service(["replica"], endpoint, tmp_path, kind="replica", id="replica-1"),
    ):
        for arm in ("arm0", "arm1"):
            client.assign(arm, OPERATOR_SCRIPT)
        client.states.wait_for(lambda state: all(arm.fresh for arm in state.arms))
        ready = EpisodeRequest(ready=EpisodeRequest.Ready(arm="arm0", ready=True))
        assert client.episode(ready).error.code == ""
        ended = client.events.wait_for(
            lambda event: event.HasField("episode_ended"), timeout_s=40
        ).episode_ended
        assert ended.outcome == OUTCOME_SUCCESS
        client.states.wait_for(
            lambda state: state.tick == ended.last_tick
        )  # events come on a way of their own
        states = [state for state in client.states.all() if state.episode == ended.number]
        states = list({state.tick: state for state in states}.values())  # a state may be said twice
        assert len(states) == ended.ticks + 1
        assert states[-1].tick == ended.last_tick
        assert all(arm.fresh for state in states[1:] for arm in state.arms)
        assert resimulated(client, states) == expected_digests(states)


def resimulated(client: RoomClient, states: list[State]) -> bytes:
    actions = b"".join(b"".join(_float64(arm.action) for arm in state.arms) for state in states[1:])
    model = client.model()
    request = RolloutRequest(
        resimulate=RolloutRequest.Resimulate(
            model_sha256=model.sha256,
            task=model.task,
            control_hz=model.control_hz,
            first_state=states[0].integration_state,
            actions=actions,
        )
    )
    reply = client.bus.query(keys.rollout("replica-1"), codec.encode(request), timeout_s=30)
    return codec.decode(RolloutReply, reply).state_digests


def expected_digests(states: list[State]) -> bytes:
    return b"".join(hashlib.blake2b(state.integration_state, digest_size=16).digest() for state in states[1:])


def _float64(values: Iterable[float]) -> bytes:
    return np.array(list(values), dtype="<f8").tobytes()


def test_a_replica_answers_bad_requests_in_words(client: RoomClient, endpoint: str, tmp_path: Path) -> None:
    with running_service(
        ["replica", "--name", "replica-2"], endpoint, tmp_path, kind="replica", id="replica-2"
    ) as replica:
        for payload, code in (
            (b"\xff\x00garbage", "InvalidInput"),
            (codec.encode(RolloutRequest(step=RolloutRequest.Step(session="gone"))), "NotFound"),
        ):
            reply = client.bus.query(keys.rollout("replica-2"), payload, timeout_s=10)
            assert codec.decode(RolloutReply, reply).error.code == code
        assert replica.terminate() == 0
        assert "Traceback" not in replica.log()
