"""RoomManager opened and closed meanwhile: what is allowed, and what becomes of it. Nothing is started here."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mart.platform.run import saved_rooms as kept_rooms
from mart.platform.run.plan import (
    DEFAULT_TASK,
    PlatformOptions,
    Process,
    processes,
)
from mart.platform.run.room_manager import (
    MAX_ROOMS,
    SILENCE_S,
    HeardStatuses,
    RoomManager,
)
from mart.platform.run.supervisor import Supervisor
from mart.protocol import clock
from mart.protocol.errors import Conflict, InvalidInput, MartError, NotFound, Unavailable
from mart.protocol.messages import (
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    RoomsRequest,
    RoomStatus,
    Seat,
)
from tests.support.drawer_demonstration import TASK_FILE

Open, Close = RoomsRequest.Open, RoomsRequest.Close
KEPT = {"old": "a_task_that_was", "lab": DEFAULT_TASK}


class Noted(Supervisor):
    """Keeps the file's processes, and tells no supervisor."""

    def _update(self) -> None:
        self._write()


@pytest.fixture
def options(tmp_path: Path) -> PlatformOptions:
    return PlatformOptions(tmp_path, seed=7)


@pytest.fixture
def supervisor(options: PlatformOptions, tmp_path: Path) -> Supervisor:
    return Noted(options, processes(options), tmp_path / "socket")


@pytest.fixture
def statuses() -> HeardStatuses:
    heard = HeardStatuses()
    heard.hear(status_of(), clock.monotonic_s())
    return heard


def status_of(*people: str) -> RoomStatus:
    seats = [Seat(arm="arm0", operator=OPERATOR_SCRIPT)]
    seats += [Seat(arm="arm1", operator=OPERATOR_HUMAN, name=name) for name in people]
    return RoomStatus(room="room-1", seats=seats)


@pytest.fixture
def rooms(options: PlatformOptions, supervisor: Supervisor, statuses: HeardStatuses) -> RoomManager:
    return RoomManager(options, supervisor, statuses)


def opened(rooms: RoomManager, task: str = DEFAULT_TASK, **asked: Any) -> str:
    return rooms.answer(RoomsRequest(open=Open(task=task, **asked))).status.room


def close(rooms: RoomManager, name: str, *, with_people: bool = False) -> None:
    rooms.answer(RoomsRequest(close=Close(room=name, with_people=with_people)))


def sim(supervisor: Supervisor, name: str) -> Process:
    return next(process for process in supervisor.processes if process.name == f"sim-{name}")


def test_a_new_room_is_a_sim_that_is_kept_running(rooms: RoomManager, supervisor: Supervisor) -> None:
    assert opened(rooms, task="three_arm_lift_wiping", control_hz=60.0) == "room-2"
    command = " ".join(sim(supervisor, "room-2").command)
    assert command == "sim --room room-2 --task three_arm_lift_wiping --control-hz 60"  # a seed of its own
    assert "[program:sim-room-2]" in supervisor.config.read_text()
    assert opened(rooms, room="lab") == "lab"
    assert sim(supervisor, "lab").command[-2:] == ("--control-hz", "auto")  # nobody gave a rate
    assert rooms.names == ["lab", "room-1", "room-2"]


def test_a_plan_travels_to_the_sim(rooms: RoomManager, supervisor: Supervisor) -> None:
    opened(rooms, episodes=50)
    assert sim(supervisor, "room-2").command[-2:] == ("--episodes", "50")


def test_what_a_room_lets_people_record_travels_to_the_sim_and_comes_back(
    rooms: RoomManager, supervisor: Supervisor, options: PlatformOptions, statuses: HeardStatuses
) -> None:
    opened(rooms, task="practice_course", practice=True)
    opened(rooms, course_required=True)
    again = RoomManager(options, Noted(options, processes(options), options.data_dir / "other"), statuses)
    again.reopen()
    for manager, supervised in ((rooms, supervisor), (again, again._supervisor)):
        assert manager.names == ["room-1", "room-2", "room-3"]
        assert sim(supervised, "room-2").command[-1] == "--practice"
        assert sim(supervised, "room-3").command[-1] == "--course-required"


def test_a_practice_room_counts_nothing(rooms: RoomManager) -> None:
    for asked in ({"episodes": 5}, {"course_required": True}):
        with pytest.raises(InvalidInput):
            opened(rooms, practice=True, **asked)
    assert rooms.names == ["room-1"]


def test_a_free_name_is_that_of_no_room_that_ever_was(rooms: RoomManager, options: PlatformOptions) -> None:
    """Or it would go on counting the episodes of somebody else's session."""
    (options.data_dir / "rooms").mkdir()
    (options.data_dir / "rooms" / "room-2.json").touch()
    assert opened(rooms) == "room-3"
    assert opened(rooms, room="room-2") == "room-2"


def test_others_are_not_started_anew_when_one_closes(rooms: RoomManager, supervisor: Supervisor) -> None:
    def sections() -> set[str]:
        return set(supervisor.config.read_text().split("\n[program:"))

    opened(rooms)
    before = sections()
    close(rooms, "room-1")
    assert sections() < before
    assert rooms.names == ["room-2"]


@pytest.mark.parametrize(
    ("asked", "error", "complaint"),
    [
        ({"task": "juggling"}, NotFound, "juggling"),
        ({"task": str(TASK_FILE)}, NotFound, "There is no task"),  # files are for who starts the platform
        ({"room": "room-1"}, Conflict, "open already"),
        ({"room": "../x"}, InvalidInput, "lower-case"),
        ({"control_hz": 4.0}, InvalidInput, "from 5 to 100 Hz"),
        ({"control_hz": float("nan")}, InvalidInput, "from 5 to 100 Hz"),
        ({"episodes": 10_001}, InvalidInput, "at most 10000"),
    ],
)
def test_what_cannot_be_opened(
    rooms: RoomManager, asked: dict[str, Any], error: type[MartError], complaint: str
) -> None:
    with pytest.raises(error, match=complaint):
        opened(rooms, **asked)
    assert rooms.names == ["room-1"]


def test_what_people_opened_comes_back(
    rooms: RoomManager, options: PlatformOptions, supervisor: Supervisor
) -> None:
    opened(rooms, room="lab", episodes=50, control_hz=30.0)
    opened(rooms)
    close(rooms, opened(rooms))
    before = {process.name for process in supervisor.processes}
    again = Noted(options, processes(options), options.data_dir / "socket")
    RoomManager(options, again, HeardStatuses()).reopen()
    assert {process.name for process in again.processes} == before
    assert sim(again, "lab").command == sim(supervisor, "lab").command


def test_the_first_room_is_what_the_command_says(rooms: RoomManager, options: PlatformOptions) -> None:
    """Though one of its name was opened before."""
    opened(rooms, room="lab")
    first = replace(options, room="lab", task="three_arm_lift_wiping")
    supervisor = Noted(first, processes(first), options.data_dir / "socket")
    RoomManager(first, supervisor, HeardStatuses()).reopen()
    assert [process.id for process in supervisor.processes if process.kind == "sim"] == ["lab"]
    assert "three_arm_lift_wiping" in sim(supervisor, "lab").command


def test_a_room_that_cannot_come_back_is_named_and_the_others_come(
    rooms: RoomManager, options: PlatformOptions, caplog: pytest.LogCaptureFixture
) -> None:
    path = options.data_dir / "rooms.jsonl"
    kept_rooms.save(path, [Open(room=name, task=task, control_hz=20.0) for name, task in KEPT.items()])
    rooms.reopen()
    assert rooms.names == ["lab", "room-1"]
    assert "Room old does not come back" in caplog.text
    opened(rooms)
    assert [room.room for room in kept_rooms.load(path)] == ["lab", "room-2"]


@pytest.mark.parametrize("damage", [b"{", b"\xff", b'{"room": 7}\n', b'{"colour": "red"}\n'])
def test_a_damaged_list_is_put_aside_and_said(
    rooms: RoomManager, options: PlatformOptions, caplog: pytest.LogCaptureFixture, damage: bytes
) -> None:
    path = options.data_dir / "rooms.jsonl"
    path.write_bytes(damage)
    rooms.reopen()
    assert rooms.names == ["room-1"]
    assert "is no list of rooms" in caplog.text
    assert path.with_suffix(".damaged").read_bytes() == damage
    assert opened(rooms) == "room-2"
    assert [room.room for room in kept_rooms.load(path)] == ["room-2"]


def test_a_full_disk_takes_no_room_from_people(
    rooms: RoomManager, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(kept_rooms, "save", full)
    assert opened(rooms) == "room-2"
    assert "No space left" in caplog.text


def test_rooms_are_bounded(rooms: RoomManager) -> None:
    for _ in range(MAX_ROOMS - 1):
        opened(rooms)
    with pytest.raises(Conflict, match=f"{MAX_ROOMS} rooms are open"):
        opened(rooms)


def test_a_room_with_people_or_a_recording_stays(rooms: RoomManager, statuses: HeardStatuses) -> None:
    statuses.hear(status_of("Ana"), clock.monotonic_s())
    with pytest.raises(Conflict, match="Ana can still drive"):
        close(rooms, "room-1")
    recording = status_of("Ana")
    recording.episode.phase = EPISODE_PHASE_RECORDING
    statuses.hear(recording, clock.monotonic_s())
    with pytest.raises(Conflict, match="being recorded"):
        close(rooms, "room-1", with_people=True)
    with pytest.raises(NotFound, match="room-9"):
        close(rooms, "room-9")
    statuses.forget("room-1")  # a sim that never spoke
    close(rooms, "room-1")
    with pytest.raises(InvalidInput, match="An empty request"):
        rooms.answer(RoomsRequest())


def test_a_host_closes_a_room_with_people(rooms: RoomManager, statuses: HeardStatuses) -> None:
    statuses.hear(status_of("Ana"), clock.monotonic_s())
    close(rooms, "room-1", with_people=True)
    assert "room-1" not in rooms.names


def test_a_room_whose_sim_is_gone_can_be_closed_though_people_sat_there(
    rooms: RoomManager, statuses: HeardStatuses
) -> None:
    """Nobody says that they have left."""
    statuses.hear(status_of("Ana"), clock.monotonic_s() - 2 * SILENCE_S)
    close(rooms, "room-1")
    assert rooms.names == []


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), Unavailable("It is gone.")])
def test_a_room_that_the_supervisor_was_not_told_of_is_not_open(
    rooms: RoomManager, supervisor: Supervisor, monkeypatch: pytest.MonkeyPatch, failure: Exception
) -> None:
    """Nor is one closed that still runs; and the next try may succeed."""

    def fail() -> None:
        raise failure

    with monkeypatch.context() as broken:
        broken.setattr(supervisor, "_update", fail)
        with pytest.raises(Unavailable):
            opened(rooms, room="lab")
        with pytest.raises(Unavailable):
            close(rooms, "room-1")
    assert rooms.names == ["room-1"]
    assert "sim-lab" not in supervisor.config.read_text()
    assert opened(rooms, room="lab") == "lab"
