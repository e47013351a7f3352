"""Which seats are driven, over an in-memory bus: found, followed through changes, and left where it cannot be done."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any, TypeVar

import pytest

from mart.operators.driver import SeatDriver
from mart.protocol import codec, keys
from mart.protocol.errors import NotFound, Unavailable
from mart.protocol.messages import (
    CUE_GO,
    CUE_WAIT,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    ArmState,
    Command,
    Cue,
    Event,
    Observation,
    Operator,
    State,
    pose_message,
)
from mart.protocol.pose import Pose
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from mart.trainer.serve.policy_seats import PromotedPolicies
from tests.support.message_collector import MessageCollector
from tests.trainer.serve.toys import Wanderer
from tests.web.room import Room

ARMS = ("arm0", "arm1")

T = TypeVar("T")


class AtOnce(Executor):
    """What is asked for is done before anything else; where it is `held`, when it is `released`."""

    def __init__(self) -> None:
        self.held = False
        self._waiting: list[Callable[[], None]] = []

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        future: Future[T] = Future()

        def do() -> None:
            try:
                future.set_result(fn(*args, **kwargs))
            except Exception as error:  # noqa: BLE001 - as an executor does
                future.set_exception(error)

        self._waiting.append(do)
        if not self.held:
            self.release()
        return future

    def release(self) -> None:
        while self._waiting:
            self._waiting.pop(0)()


class Stand:
    """A room without a world, the driver, and what they say."""

    def __init__(self, bus: MemoryBus, policies: dict[str, Wanderer]) -> None:
        self.loader = AtOnce()
        self.bus, self.policies = bus, policies
        self.room = Room(bus)
        self.selection = PromotedPolicies(Path("policies"), self.load, self.loader)
        self.driver = SeatDriver(bus, None, self.selection)
        self.commands = MessageCollector(bus, keys.commands("room-1"), Command)
        self.events = MessageCollector(bus, keys.event("room-1").key, Event)
        self.loaded: list[str] = []
        self.tick = 0

    def load(self, checkpoint: Path) -> Wanderer:
        self.loaded.append(checkpoint.name)
        if checkpoint.name not in self.policies:
            raise NotFound.named("policy", checkpoint.name, self.policies)
        return self.policies[checkpoint.name]

    def assign(self, arm: str, policy: str = "", operator: Operator = OPERATOR_POLICY) -> None:
        self.room.seats.assign(arm, operator, policy)
        self.room.publish()

    def show(self) -> list[tuple[str, int]]:
        """A new state; (arm, epoch) of the commands that it brought forth."""
        self.tick += 1
        seen = [Observation(name=f"{arm}/tool_position_in_base", value=[0.5, 0.0, 0.3]) for arm in ARMS]
        arms = [
            ArmState(arm=arm, tool_in_base=pose_message(Pose.identity()), action=[0.0] * 7) for arm in ARMS
        ]
        state = State(boot=1, tick=self.tick, sim_time_s=self.tick / 20, observations=seen, arms=arms)
        before = len(self.commands)
        self.bus.publisher(keys.state("room-1")).put(codec.encode(state))
        self.driver.work()
        return [(command.arm, command.seat_epoch) for command in self.commands.all()[before:]]

    def close(self) -> None:
        self.driver.close()
        self.room.close()


@pytest.fixture
def stand() -> Iterator[Stand]:
    policies = {
        "alone": Wanderer(),
        "together": Wanderer(joint=True),
        "elsewhere": Wanderer(task="another"),
        "slow": Wanderer(hz=10.0),
        "quick": Wanderer(hz=30.0),
        "small": Wanderer(("arm0",)),
    }
    with contextlib.closing(Stand(MemoryNetwork().connect(), policies)) as stand:
        yield stand


def test_a_seat_is_driven_as_soon_as_it_names_a_policy_and_no_longer(stand: Stand) -> None:
    assert stand.show() == []
    stand.assign("arm1", "alone")
    assert stand.show() == [("arm1", 2)]
    stand.assign("arm1", operator=OPERATOR_HOLD)
    assert stand.show() == []


def test_a_joint_policy_drives_all_its_seats_with_one_memory(stand: Stand) -> None:
    for arm in ARMS:
        stand.assign(arm, "together")
    assert stand.show() == [("arm0", 2), ("arm1", 2)]
    assert len(stand.policies["together"].given) == 1
    stand.room.seats.claim("arm0", "ana", "Ana", OPERATOR_HUMAN)
    stand.room.publish()
    assert stand.show() == [("arm1", 2)]
    stand.room.seats.hand_back("arm0", "ana")
    stand.room.publish()
    assert stand.show() == [("arm0", 4), ("arm1", 2)]
    assert stand.loaded == ["together"]


def test_a_policy_obeys_the_people_of_its_room_alone(stand: Stand) -> None:
    stand.assign("arm1", "alone")
    stand.show()
    part = stand.policies["alone"].parts["arm1"]

    def asked_after(cue: Cue) -> int:  # a word of arm0's, in three ticks
        before, given = len(part.given), Event.CueGiven(arm="arm0", cue=cue)
        said = codec.encode(Event(room="room-1", tick=stand.tick, cue_given=given))
        stand.bus.publisher(keys.event("room-1")).put(said)
        stand.driver.work()
        assert [stand.show() for _ in range(3)] == [[("arm1", 2)]] * 3
        return len(part.given) - before

    assert asked_after(CUE_WAIT) == 3  # nobody sits there
    stand.room.seats.claim("arm0", "ana", "Ana", OPERATOR_HUMAN)
    stand.room.publish()
    assert [asked_after(CUE_WAIT), asked_after(CUE_GO)] == [0, 3]


def test_a_policy_of_a_slower_rate_speaks_at_every_tick_and_acts_at_its_own(stand: Stand) -> None:
    stand.assign("arm1", "slow")
    assert [stand.show() for _ in range(4)] == [[("arm1", 2)]] * 4
    part = stand.policies["slow"].parts["arm1"]
    assert len(part.given) == 2
    stand.room.control_hz = 40.0  # as between two episodes
    stand.room.publish()
    assert [stand.show() for _ in range(8)] == [[("arm1", 2)]] * 8
    assert (len(part.given), part.seeds) == (4, [0, 0])


@pytest.mark.parametrize(
    ("policy", "says"),
    [
        ("unknown", "no policy 'unknown'"),
        ("elsewhere", "trained for another"),
        ("quick", "acts 30 times a second"),
        ("small", "drives arm0"),
    ],
)
def test_what_does_not_fit_is_told_once_and_the_seat_is_left(stand: Stand, policy: str, says: str) -> None:
    stand.assign("arm1", policy)
    assert stand.show() == []
    stand.show()
    (notice,) = [event.notice for event in stand.events.all() if event.HasField("notice")]
    assert says in notice.text
    assert stand.room.seats["arm1"].operator == OPERATOR_HOLD


def test_a_policy_that_goes_astray_leaves_its_seat(stand: Stand) -> None:
    stand.assign("arm0", "together")
    stand.show()
    stand.policies["together"].spoilt = float("nan")
    assert stand.show() == []
    assert stand.room.seats["arm0"].operator == OPERATOR_HOLD
    stand.policies["together"].spoilt = None
    stand.assign("arm0", "together")  # a second chance for whoever asks again
    assert stand.show() == [("arm0", 4)]


def test_garbage_disturbs_nobody(stand: Stand) -> None:
    stand.assign("arm1", "alone")
    for topic in (keys.state("room-1"), keys.status("room-1")):
        stand.bus.publisher(topic).put(b"\xff" * 40)
        stand.driver.work()
    stand.room.publish()
    assert stand.show() == [("arm1", 2)]


def test_a_room_that_did_not_hear_that_a_seat_is_left_is_told_again(monkeypatch: pytest.MonkeyPatch) -> None:
    class Deafened(MemoryBus):
        """The first request is lost."""

        asked = 0

        def query(self, topic: keys.Topic, payload: bytes, timeout_s: float) -> bytes:
            self.asked += 1
            if self.asked == 1:
                raise Unavailable("Nobody answered.")
            return super().query(topic, payload, timeout_s)

    monkeypatch.setattr("mart.operators.driver.LEAVE_AGAIN_S", 0.0)
    with contextlib.closing(Stand(Deafened(MemoryNetwork()), {})) as stand:
        stand.assign("arm1", "unknown")
        stand.driver.work()
        assert stand.room.seats["arm1"].operator == OPERATOR_POLICY
        stand.room.publish()
        stand.driver.work()
        assert stand.room.seats["arm1"].operator == OPERATOR_HOLD
        assert len([event for event in stand.events.all() if event.HasField("notice")]) == 1


def test_a_room_that_was_closed_is_forgotten_and_one_that_comes_back_is_driven_again(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mart.operators.driver.FORGOTTEN_AFTER_S", 0.0)
    stand.assign("arm1", "alone")
    assert stand.show() == [("arm1", 2)]
    stand.driver.work()
    said = len(stand.commands)
    for _ in range(4):
        stand.driver.work()  # longer than a command is not repeated
    assert len(stand.commands) == said
    stand.room.publish()
    assert stand.show() == [("arm1", 2)]
    assert stand.loaded == ["alone", "alone"]


def test_a_driver_that_stood_still_itself_forgets_no_room(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mart.operators.driver.FORGOTTEN_AFTER_S", 0.0)
    monkeypatch.setattr("mart.operators.driver._FROZEN_S", 0.0)
    stand.assign("arm1", "alone")
    stand.show()
    stand.driver.work()
    assert stand.show() == [("arm1", 2)]
    assert stand.loaded == ["alone"]


def test_a_policy_is_loaded_beside_those_that_drive(stand: Stand) -> None:
    stand.assign("arm1", "alone")
    assert stand.show() == [("arm1", 2)]
    stand.loader.held = True
    stand.assign("arm0", "small")
    assert stand.show() == [("arm1", 2)]  # it drives on meanwhile
    stand.loader.release()
    stand.room.publish()
    assert sorted(stand.show()) == [("arm0", 2), ("arm1", 2)]


@pytest.mark.parametrize("error", [ValueError("shape"), OSError(5, "Input/output error"), RuntimeError()])
def test_one_policys_failure_is_that_policys(stand: Stand, error: Exception) -> None:
    stand.assign("arm1", "alone")
    stand.show()

    def fail(checkpoint: Path) -> Wanderer:
        raise error

    stand.selection._load = fail
    stand.assign("arm0", "small")
    assert stand.show() == [("arm1", 2)]
    assert stand.room.seats["arm0"].operator == OPERATOR_HOLD
    assert type(error).__name__ in stand.events.all()[-1].notice.text


def test_a_room_whose_sim_is_gone_is_forgotten_sooner(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.operators.driver.GONE_AFTER_S", 0.0)
    stand.assign("arm1", "alone")
    assert stand.show() == [("arm1", 2)]
    stand.room.close()
    for _ in range(3):
        stand.driver.work()
    stand.show()
    assert stand.driver._driven == {}
