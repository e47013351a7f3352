"""What a room says is heard over a real bus; a room or an arm that is not there is a sentence."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest

from mart.lerobot_devices import RoomSubscription
from mart.protocol import codec, keys
from mart.protocol.errors import NotFound, Unavailable
from mart.protocol.messages import Model, RoomStatus, State
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.operators.rooms import TASK, state_of

ROOM = "room-1"


@pytest.fixture
def bus(endpoint: str) -> Iterator[ZenohBus]:
    """A room that nobody simulates: it has a model, and says what the test says."""
    model = codec.encode(Model(task=TASK.name, arms=TASK.arm_names))
    with (
        ZenohBus.connect(endpoint) as bus,
        contextlib.closing(bus.serve(keys.model(ROOM), lambda request: request.reply(model))),
    ):
        yield bus


def _say(bus: ZenohBus, state: State) -> None:
    state.room = ROOM
    for topic, message in ((keys.state(ROOM), state), (keys.status(ROOM), RoomStatus(room=ROOM))):
        with contextlib.closing(bus.publisher(topic)) as publisher:
            publisher.put(codec.encode(message))


def test_the_newest_state_is_told(endpoint: str, bus: ZenohBus, monkeypatch: pytest.MonkeyPatch) -> None:
    with contextlib.closing(RoomSubscription(ROOM, "arm1", endpoint)) as feed:
        _say(bus, state_of(7))
        state = feed.state()
        assert (feed.task.name, state.tick, feed.arm_state(state).arm) == (TASK.name, 7, "arm1")
        assert feed.observation(state, "arm1/gripper") == [0.0]
        for missing in (
            lambda: feed.observation(state, "arm1/mood"),
            lambda: feed.arm_state(State()),
        ):
            with pytest.raises(Unavailable):
                missing()
        monkeypatch.setattr("mart.lerobot_devices.room_subscription.SILENT_AFTER_S", -1.0)
        with pytest.raises(Unavailable, match="said nothing"):
            feed.state()


def test_a_room_without_a_state_is_told(
    endpoint: str, bus: ZenohBus, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mart.lerobot_devices.room_subscription._FIRST_STATE_S", 0.01)
    with (
        contextlib.closing(RoomSubscription(ROOM, "arm1", endpoint)) as feed,
        pytest.raises(Unavailable, match="shown no state"),
    ):
        feed.state()


@pytest.mark.usefixtures("bus")
@pytest.mark.parametrize(
    ("room", "arm", "error"), [(ROOM, "arm9", NotFound), ("room-9", "arm0", Unavailable)]
)
def test_what_is_not_there_is_a_sentence(
    endpoint: str, room: str, arm: str, error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    if room != ROOM:
        monkeypatch.setattr("mart.lerobot_devices.room_subscription._TIMEOUT_S", 0.2)
    with pytest.raises(error):
        RoomSubscription(room, arm, endpoint)


def test_without_a_router_nobody_is_waited_for() -> None:
    with pytest.raises(Unavailable):
        RoomSubscription(ROOM, "arm0", f"tcp/127.0.0.1:{free_port()}")
