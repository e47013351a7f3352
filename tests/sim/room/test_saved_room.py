"""What a room keeps over a restart."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.errors import Corrupt
from mart.protocol.messages import OPERATOR_HUMAN, OPERATOR_POLICY, OPERATOR_SCRIPT
from mart.sim.room import saved_room
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.seats import NOBODY, SeatTable


def test_a_record_comes_back_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "rooms" / "room-1.json"
    seats = SeatTable(["arm0", "arm1", "arm2"])
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    seats.assign("arm1", OPERATOR_SCRIPT)
    seats.assign("arm2", OPERATOR_POLICY, "lifter")
    seats.claim("arm2", "h2", "Ben", OPERATOR_HUMAN)
    record = SavedRoom(seed=5, episodes=3, saved=2, good=1).with_seats(seats).planned("lift", 50)
    saved_room.save(path, record)
    assert saved_room.load(path) == record
    assert record.holders() == list(seats)


def test_another_task_frees_the_seats_under_epochs_that_nobody_has(tmp_path: Path) -> None:
    path = tmp_path / "room-1.json"
    seats = SeatTable(["arm0", "arm1"])
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    seats.assign("arm1", OPERATOR_SCRIPT)
    saved_room.save(path, saved_room.load_or_begin(path, "lift", None).with_seats(seats))
    assert saved_room.load_or_begin(path, "lift", None).holders() == list(seats)
    freed = saved_room.load_or_begin(path, "wipe", None).holders()
    assert [(seat.arm, seat.epoch, seat.driver) for seat in freed] == [
        ("arm0", seats["arm0"].epoch + 1, NOBODY),
        ("arm1", seats["arm1"].epoch + 1, NOBODY),
    ]


def test_seats_of_a_record_that_names_no_task_stay(tmp_path: Path) -> None:
    path = tmp_path / "room-1.json"
    seat = '{"arm": "arm0", "operator": "human", "epoch": 2, "holder_id": "h1", "name": "Ana"}'
    path.write_text(f'{{"seed": 1, "seats": [{seat}]}}')  # of 0.2 and older
    record = saved_room.load_or_begin(path, "lift", None)
    assert (record.task, [one.name for one in record.holders()]) == ("lift", ["Ana"])


def test_a_plan_counts_from_when_it_was_made() -> None:
    record = SavedRoom(seed=5, saved=4, good=3).planned("lift", 50)
    assert record.with_changes(good=5).planned("lift", 50) == record.with_changes(good=5)  # a restart
    for task, episodes in (("wipe", 50), ("lift", 20)):
        anew = record.with_changes(good=5).planned(task, episodes).plan
        assert anew is not None
        assert (anew.task, anew.episodes, anew.good_before) == (task, episodes, 5)
    assert record.planned("lift", None).plan is None


def test_an_episode_counts_once_whatever_is_told_of_it_and_becomes_good_once() -> None:
    record = SavedRoom(seed=5, episodes=600)
    for number, good in (
        (1, False),
        (1, False),
        (1, True),
        (1, True),
        (1, False),
        (2, True),
        (0, True),
        (601, True),
    ):
        record = record.with_saved(number, good)
    assert (record.saved, record.good) == (2, 2)
    for number in range(3, 601):
        record = record.with_saved(number, good=False)
    assert (record.saved, record.good, len(record.counted)) == (600, 2, 256)
    assert record.with_saved(1, good=True) is record


def test_a_room_asks_for_its_newest_episodes_of_which_nobody_told() -> None:
    assert SavedRoom(seed=5).uncounted() == ()
    record = SavedRoom(seed=5, episodes=9).with_saved(8, good=True)
    assert record.uncounted() == (6, 7, 9)


def test_a_room_that_never_ran_has_no_record(tmp_path: Path) -> None:
    assert saved_room.load(tmp_path / "room-1.json") is None


def test_a_record_is_replaced_and_only_its_owner_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "room-1.json"
    for episodes in (1, 2):
        saved_room.save(path, SavedRoom(seed=5, episodes=episodes))
    assert [file.name for file in tmp_path.iterdir()] == ["room-1.json"]
    assert path.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        '{"seed": -1}',
        '{"seed": 1, "colour": "red"}',
        '{"seed": 1, "seats": [{"arm": "arm0", "operator": "nobody", "epoch": 1, "holder_id": "", "name": ""}]}',
        '{"seed": 1, "seats": [{"arm": "arm0", "operator": "hold", "epoch": 0, "holder_id": "", "name": ""}]}',
    ],
)
def test_a_spoilt_record_is_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "room-1.json"
    path.write_text(text)
    with pytest.raises(Corrupt, match=r"room-1\.json"):
        saved_room.load(path)


def test_a_spoilt_record_is_put_aside_and_the_room_begins_anew(tmp_path: Path) -> None:
    path = tmp_path / "room-1.json"
    path.write_text('{"seed": 1, "episodes": 4294967295}')
    assert saved_room.load_or_put_aside(path) is None
    (aside,) = tmp_path.iterdir()
    assert aside.name.startswith("room-1.json.unusable-")
    assert "4294967295" in aside.read_text()
