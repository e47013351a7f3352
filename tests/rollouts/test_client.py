"""The client of replicas, on a real router; each replica is a toy whose worlds count their steps."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from mart.protocol import codec, keys
from mart.protocol.batch_state import BatchState, pack
from mart.protocol.errors import Conflict, InvalidInput, MartError, NotFound, Unavailable
from mart.protocol.messages import Model, RolloutReply, RolloutRequest, error_message
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import ServiceKind
from mart.rollouts.client import RolloutClient
from mart.runtime.bus import Bus, Request
from mart.runtime.bus.memory import MemoryNetwork
from mart.runtime.bus.zenoh_bus import ZenohBus
from tests.support.deaf_bus import DeafBus

TASK = get_task("two_arm_multi_cube_lifting")
WAIT_S = 30.0


@pytest.fixture
def bus(endpoint: str) -> Iterator[Bus]:
    with ZenohBus.connect(endpoint) as bus:
        yield bus


class ToyReplica:
    """Its worlds' sim time is their seed plus the sum of what they were told."""

    def __init__(self, endpoint: str, name: str) -> None:
        self.sessions: dict[str, np.ndarray] = {}
        self.step_numbers: list[int] = []
        self.at_a_step = threading.Event()
        self.may_step = threading.Event()
        self.may_step.set()
        self._name = name
        self._opened = 0
        self._requests: queue.SimpleQueue[Request | None] = queue.SimpleQueue()
        self._bus = ZenohBus.connect(endpoint)
        self._bus.serve(keys.rollout(name), self._requests.put)
        self._bus.announce(keys.alive(ServiceKind.REPLICA, name))
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self) -> None:
        self._requests.put(None)
        self._thread.join()
        self._bus.close()

    def _run(self) -> None:
        for request in iter(self._requests.get, None):
            try:
                reply = self._answer(codec.decode(RolloutRequest, request.payload))
            except MartError as error:
                reply = RolloutReply(error=error_message(error))
            request.reply(codec.encode(reply))

    def _answer(self, request: RolloutRequest) -> RolloutReply:
        if request.HasField("reset"):
            self._opened += 1
            session = f"{self._name}-{self._opened}"
            self.sessions[session] = np.array(request.reset.seeds, np.float64)
            return self._standing(session)
        session = request.step.session or request.close.session
        if session not in self.sessions:
            raise NotFound(f"There is no session {session!r}.")
        if request.HasField("close"):
            del self.sessions[session]
            return RolloutReply(session=session)
        self.step_numbers.append(request.step.number)
        self.at_a_step.set()
        self.may_step.wait(WAIT_S)
        times = self.sessions[session]
        told = np.frombuffer(request.step.actions).reshape(len(times), -1).sum(axis=1)
        times += np.where(np.frombuffer(request.step.running, np.uint8), told, 0.0)
        return self._standing(session)

    def _standing(self, session: str) -> RolloutReply:
        times = self.sessions[session].copy()
        none = np.zeros(len(times), bool)
        worlds = BatchState(
            observations={o.name: np.zeros((len(times), *o.shape)) for o in TASK.observations},
            subtasks=np.zeros((len(times), len(TASK.subtasks)), bool),
            success=none,
            failed=none,
            sim_time_s=times,
            success_ticks=np.zeros(len(times), np.uint32),
            reasons=("",) * len(times),
        )
        return RolloutReply(session=session, worlds=pack(worlds))


@contextlib.contextmanager
def toys(endpoint: str, bus: Bus, *names: str) -> Iterator[list[ToyReplica]]:
    with contextlib.ExitStack() as opened:
        seen: queue.SimpleQueue[str] = queue.SimpleQueue()
        bus.watch(keys.alive_of(ServiceKind.REPLICA), lambda key, alive: seen.put(key) if alive else None)
        replicas = [opened.enter_context(contextlib.closing(ToyReplica(endpoint, name))) for name in names]
        for _ in names:
            seen.get(timeout=WAIT_S)
        yield replicas


def told(values: list[float]) -> np.ndarray:
    actions = np.zeros((len(values), 2, 7))
    actions[:, 0, 0] = values
    return actions


def test_a_batch_is_spread_and_comes_back_in_order(endpoint: str, bus: Bus) -> None:
    with toys(endpoint, bus, "a", "b", "c") as replicas, RolloutClient(bus, ["a", "b", "c"]) as client:
        seeds = [10, 20, 30, 40, 50, 60, 70]
        assert client.reset(TASK.name, seeds).sim_time_s.tolist() == seeds
        assert sorted(len(times) for toy in replicas for times in toy.sessions.values()) == [2, 2, 3]
        stepped = client.step(told([0.1 * i for i in range(7)]))
        assert stepped.sim_time_s == pytest.approx([10, 20.1, 30.2, 40.3, 50.4, 60.5, 70.6])
        running = np.arange(7) == 3
        some = client.step(told([0.5] * 7), running)
        assert (some.sim_time_s - stepped.sim_time_s).tolist() == pytest.approx([0, 0, 0, 0.5, 0, 0, 0])
        assert list(some.observations) == [observation.name for observation in TASK.observations]


def test_steps_are_numbered_from_one_in_every_episode(endpoint: str, bus: Bus) -> None:
    with toys(endpoint, bus, "a") as (replica,), RolloutClient(bus, ["a"]) as client:
        for _ in range(2):
            client.reset(TASK.name, [1])
            client.step(told([0.0]))
            client.step(told([0.0]))
    assert replica.step_numbers == [1, 2, 1, 2]


def test_with_fewer_worlds_than_replicas_some_have_none(endpoint: str, bus: Bus) -> None:
    with toys(endpoint, bus, "a", "b", "c") as replicas, RolloutClient(bus, ["a", "b", "c"]) as client:
        client.reset(TASK.name, [1, 2])
        assert sum(len(toy.sessions) for toy in replicas) == 2


def test_a_reset_and_a_close_let_go_of_worlds(endpoint: str, bus: Bus) -> None:
    with toys(endpoint, bus, "a") as (replica,):
        with RolloutClient(bus, ["a"]) as client:
            client.reset(TASK.name, [1])
            client.reset(TASK.name, [2])
            assert list(replica.sessions) == ["a-2"]
        assert not replica.sessions


def test_without_replicas_nothing_is_reset(endpoint: str, bus: Bus, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.rollouts.client._START_TIMEOUT_S", 1.5)
    with RolloutClient(bus, ["a"]) as client, pytest.raises(Unavailable, match=r"mart replica --name a"):
        client.reset(TASK.name, [1])
    with (
        toys(endpoint, bus, "b"),
        RolloutClient(bus, ["b", "a"]) as client,
        pytest.raises(Unavailable, match=r"'a' is up \(up: b\)"),
    ):
        client.reset(TASK.name, [1, 2])


def test_a_replica_whose_coming_was_not_heard_is_found() -> None:
    network = MemoryNetwork()
    replica = network.connect()
    replica.announce(keys.alive(ServiceKind.REPLICA, "a"))
    described = codec.encode(RolloutReply(model=Model(task=TASK.name)))
    replica.serve(keys.rollout("a"), lambda request: request.reply(described))
    with RolloutClient(DeafBus(network), ["a"]) as client:
        assert client.model(TASK.name).task == TASK.name


def test_what_a_replica_forgot_is_gone_everywhere(endpoint: str, bus: Bus) -> None:
    with toys(endpoint, bus, "a", "b") as (a, b), RolloutClient(bus, ["a", "b"]) as client:
        client.reset(TASK.name, [1, 2])
        b.sessions.clear()
        with pytest.raises(NotFound, match="no session 'b-1'"):
            client.step(told([0.0, 0.0]))
        assert not a.sessions
        with pytest.raises(Conflict, match="reset them"):
            client.step(told([0.0, 0.0]))
        assert client.reset(TASK.name, [3, 4]).sim_time_s.tolist() == [3, 4]


def test_a_reset_in_the_middle_of_a_step_is_refused(endpoint: str, bus: Bus) -> None:
    with toys(endpoint, bus, "a") as (replica,), RolloutClient(bus, ["a"]) as client:
        client.reset(TASK.name, [1])
        replica.may_step.clear()
        with ThreadPoolExecutor(1) as elsewhere:
            stepping = elsewhere.submit(client.step, told([0.5]))
            assert replica.at_a_step.wait(WAIT_S)
            with pytest.raises(Conflict, match="middle of a step"):
                client.reset(TASK.name, [2])
            replica.may_step.set()
            assert stepping.result(WAIT_S).sim_time_s.tolist() == [1.5]


@pytest.mark.parametrize(
    "actions", [np.zeros((1, 2, 7)), np.zeros((2, 14)), np.full((2, 2, 7), np.nan), np.full((2, 2, 7), 1.5)]
)
def test_bad_actions_are_refused_and_nothing_is_lost(endpoint: str, bus: Bus, actions: np.ndarray) -> None:
    with toys(endpoint, bus, "a"), RolloutClient(bus, ["a"]) as client:
        client.reset(TASK.name, [1, 2])
        with pytest.raises(InvalidInput):
            client.step(actions)
        with pytest.raises(InvalidInput, match="a flag for each of 2"):
            client.step(told([0.0, 0.0]), running=[True])
        assert client.step(told([0.5, 0.5])).sim_time_s.tolist() == [1.5, 2.5]


@pytest.mark.parametrize("seeds", [[], [-1], [2**64], [1, 2.5]])
def test_seeds_that_cannot_be_are_refused(endpoint: str, bus: Bus, seeds: list[int]) -> None:
    with toys(endpoint, bus, "a"), RolloutClient(bus, ["a"]) as client, pytest.raises(InvalidInput):
        client.reset(TASK.name, seeds)


@pytest.mark.parametrize(
    ("task", "arms", "error"), [("juggling", None, NotFound), (TASK.name, 9, InvalidInput)]
)
def test_tasks_that_cannot_be_are_refused(
    bus: Bus, task: str, arms: int | None, error: type[MartError]
) -> None:
    with RolloutClient(bus, ["a"]) as client, pytest.raises(error):
        client.reset(task, [1], arms=arms)


@pytest.mark.parametrize("replicas", [[], ["a", "a"]])
def test_replicas_are_named_once_each(bus: Bus, replicas: list[str]) -> None:
    with pytest.raises(InvalidInput, match="once"):
        RolloutClient(bus, replicas)
