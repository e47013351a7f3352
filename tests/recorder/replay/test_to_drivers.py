"""Before anything moves, a replay looks at file and room, refuses what does not fit, and says what would move."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest
from click.testing import CliRunner

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, keys
from mart.protocol.errors import Conflict, InvalidInput, MartError, Unavailable
from mart.protocol.messages import (
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    DrivenArm,
    EmergencyStop,
    Model,
    RoomStatus,
    Seat,
    State,
)
from mart.recorder.replay import saying, to_drivers
from mart.recorder.replay.to_drivers import Replay, Replayed, lead, prepare
from mart.recorder.replay_cli import confirm
from mart.runtime.bus import Bus
from mart.runtime.bus.memory import MemoryNetwork
from mart.sim.world import World
from tests.trainer import recorded

ROOM = recorded.ROOM


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(recorded.TASK)


@pytest.fixture(scope="module")
def states(world: World) -> list[State]:
    return recorded.perform(world, seed=1)[:61]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory, world: World, states: list[State]) -> EpisodeFile:
    return EpisodeFile.open(recorded.write(tmp_path_factory.mktemp("episodes"), world, states))


class Met:
    """A room whose arm0 is real, as it looks on the bus."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, world: World, file: EpisodeFile, state: State
    ) -> None:
        self.file = file
        self.bus: Bus = MemoryNetwork().connect()
        self.state = State()
        self.state.CopyFrom(state)
        self.status = RoomStatus(
            room=ROOM,
            task=recorded.TASK,
            control_hz=20.0,
            seats=[Seat(arm=arm) for arm in world.arms],
            driven_arms=[DrivenArm(arm="arm0", driver="MyArm")],
        )
        self.status.episode.phase = EPISODE_PHASE_PRACTICE
        model = Model(sha256=world.model_sha256)
        self.bus.serve(keys.model(ROOM), lambda request: request.reply(codec.encode(model)))
        monkeypatch.setattr(to_drivers, "_look", lambda _bus, _room: (self.status, self.state))

    def prepare(self, *arms: str) -> Replay:
        return prepare(self.bus, self.file, ROOM, arms, 0.25)


@pytest.fixture
def met(monkeypatch: pytest.MonkeyPatch, world: World, file: EpisodeFile, states: list[State]) -> Met:
    return Met(monkeypatch, world, file, states[10])


def test_it_says_which_arms_will_move_for_how_long_from_where_and_how_it_ended(met: Met) -> None:
    replay = met.prepare()
    assert replay.drivers == {"arm0": "MyArm"}
    total_s = replay.led.approach_s + 60 * 0.05 / 0.25
    assert replay.led.duration_s == pytest.approx(total_s)
    said = saying.before(replay, met.file)
    assert f"arm0 of {ROOM} will move for about {total_s:.0f} s" in said
    assert "to where episode 1 of room-1 began, then 12 s along its way at 0.25 of its speed." in said
    assert "arm0: driven by MyArm; its tool stands at (0." in said
    assert "arm1" not in said
    told, words = saying.after(replay, Replayed(3.2, "Ben stopped everything."), met.file)
    assert words == f"arm0 of {ROOM} stands after 3 of {total_s:.0f} s: Ben stopped everything."
    assert (told["led_s"], told["why_ended"], told["arms"]) == (3.2, "Ben stopped everything.", ["arm0"])


def no_driver(met: Met) -> None:
    del met.status.driven_arms[:]


def stopped(met: Met) -> None:
    met.status.stop.CopyFrom(EmergencyStop(name="Ben"))


def recording(met: Met) -> None:
    met.status.episode.phase = EPISODE_PHASE_RECORDING


def another_task(met: Met) -> None:
    met.status.task = "two_arm_drink_tray_lifting"


def another_arm(met: Met) -> None:
    met.status.arm_kinds.extend(["ur5e", "panda"])


def far(met: Met) -> None:
    met.state.arms[0].tool_in_base.z += 0.3


@pytest.mark.parametrize(
    ("happens", "kind", "said"),
    [
        (no_driver, InvalidInput, "No driver drives arm0, arm1 of room-1; drivers drive none there."),
        (stopped, Conflict, "Ben stopped everything."),
        (recording, Conflict, "An episode is under way in room-1"),
        (another_task, InvalidInput, "Open a room of the same task."),
        (another_arm, InvalidInput, "arm0 was a panda when it was recorded; arm0 of room-1 is a ur5e."),
        (far, Conflict, "arm0 stands too far from where the recording began"),
    ],
)
def test_what_does_not_fit_is_refused_in_a_sentence(
    met: Met, happens: Callable[[Met], None], kind: type[MartError], said: str
) -> None:
    happens(met)
    with pytest.raises(kind) as refused:
        met.prepare()
    assert said in str(refused.value)


def test_an_arm_that_is_simulated_is_not_led(met: Met) -> None:
    with pytest.raises(InvalidInput, match="No driver drives arm1 of room-1; drivers drive arm0 there"):
        met.prepare("arm1")


def test_a_room_that_is_not_there_is_unavailable(monkeypatch: pytest.MonkeyPatch, file: EpisodeFile) -> None:
    monkeypatch.setattr(to_drivers, "_TIMEOUT_S", 0.2)
    with pytest.raises(Unavailable, match="room-9 was not heard"):
        prepare(MemoryNetwork().connect(), file, "room-9", (), 0.25)


def test_a_seat_that_cannot_be_had_ends_it_with_the_room_s_words(met: Met) -> None:
    replay, stop = met.prepare(), threading.Event()
    ended = lead(met.bus, replay, stop)
    assert ended.led_s == 0.0
    assert ended.why
    assert stop.is_set()


@pytest.mark.parametrize("answer", ["", "n\n", "\n"])
def test_without_a_yes_nothing_moves(answer: str) -> None:
    with (
        CliRunner().isolation(input=answer),
        pytest.raises(InvalidInput, match="Nobody said yes, so nothing moved"),
    ):
        confirm(yes=False)


def test_a_yes_is_said_or_given_beforehand() -> None:
    with CliRunner().isolation(input="y\n"):
        confirm(yes=False)
    confirm(yes=True)
