from __future__ import annotations

import pytest

from mart.platform.inspect.rooms import as_json, in_words
from mart.platform.run.room_statuses import open_rooms
from mart.protocol import keys
from mart.protocol import messages as m
from mart.protocol.codec import encode
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Closable, Handler
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from tests.protocol.message_examples import examples


class Answering(MemoryBus):
    """A bus on which a room tells its status as soon as somebody listens."""

    def subscribe(self, key_expression: str, handler: Handler, *, recover: bool = False) -> Closable:
        subscription = super().subscribe(key_expression, handler, recover=recover)
        self.publisher(keys.status("room-1")).put(encode(examples()["RoomStatus"]))
        return subscription


def test_a_room_is_shown_with_its_people_and_whom_it_waits_for() -> None:
    bus = Answering(MemoryNetwork())
    bus.announce(keys.alive(ServiceKind.SIM, "room-1"))
    (status,) = open_rooms(bus)
    assert "arm0 Ana" in in_words(status)
    assert "waiting for arm1 for 0.8 s" in in_words(status)
    assert "episode 2 of 50" in in_words(status)
    assert as_json(status)["plan"] == {"episodes": 50, "good": 1}
    assert as_json(status)["waiting_for"] == [{"arm": "arm1", "since_s": 0.8}]
    assert as_json(status)["seats"] == [{"arm": "arm0", "operator": "human", "name": "Ana"}]


def test_the_kinds_of_arms_are_shown_where_they_are_not_all_pandas() -> None:
    status = examples()["RoomStatus"]
    assert isinstance(status, m.RoomStatus)
    del status.arm_kinds[:]
    assert "arm0 Ana" in in_words(status)
    assert as_json(status)["arm_kinds"] == ["panda"]
    status.arm_kinds.append("ur5e")
    assert "arm0 (ur5e) Ana" in in_words(status)
    assert as_json(status)["arm_kinds"] == ["ur5e"]


def test_no_sim_means_no_room_and_no_wait() -> None:
    assert open_rooms(MemoryNetwork().connect()) == []


def test_a_room_that_waits_for_nobody_says_nothing_of_waiting() -> None:
    assert "waiting" not in in_words(m.RoomStatus(room="room-1", barrier=m.BARRIER_PHASE_RUNNING))


@pytest.mark.parametrize(
    ("good", "words"), [(0, "episode 1 of 2"), (1, "episode 2 of 2"), (2, "all 2 episodes recorded")]
)
def test_a_plan_counts_good_episodes(good: int, words: str) -> None:
    assert words in in_words(m.RoomStatus(room="room-1", plan=m.Plan(episodes=2, good=good)))


def test_without_a_plan_nothing_is_counted() -> None:
    assert as_json(m.RoomStatus(room="room-1"))["plan"] is None
    assert "episode " not in in_words(m.RoomStatus(room="room-1"))


def test_real_arms_are_named_with_their_drivers() -> None:
    status = m.RoomStatus(room="room-1")
    status.driven_arms.add(arm="arm0", driver="OurArm", age_s=0.012)
    status.driven_arms.add(arm="arm1", fault="No driver has connected.")
    assert in_words(status).splitlines()[1:] == [
        "  arm0 is real, OurArm: measured 0.01 s ago",
        "  arm1 is real, without a driver: No driver has connected.",
    ]
    assert [one["driver"] for one in as_json(status)["driven_arms"]] == ["OurArm", ""]


def test_cameras_are_named_with_how_they_do() -> None:
    status = m.RoomStatus(room="room-1")
    status.cameras.add(camera="arm0-wrist", frames_per_s=29.0, width_px=1280, height_px=720)
    status.cameras.add(camera="table", dark="Its picture is frozen.")
    assert in_words(status).splitlines()[1:] == [
        "  camera arm0.wrist: 29 pictures a second, 1280 x 720",
        "  camera table: Its picture is frozen.",
    ]
    assert [one["dark"] for one in as_json(status)["cameras"]] == ["", "Its picture is frozen."]


def test_the_score_of_the_course_is_shown_station_by_station() -> None:
    status = m.RoomStatus(room="room-2", task="practice_course", practice=True)
    status.seats.append(m.Seat(arm="arm0", operator=m.OPERATOR_HUMAN, name="Ana"))
    status.episode.phase = m.EPISODE_PHASE_PRACTICE
    for name, seconds, tries in (("reach0", 3.24, 1), ("turn0", 5.0, 2), ("grip0", 1.0, 1)):
        status.progress.subtasks.add(name=name, done=True, seconds=seconds, tries=tries)
    status.progress.subtasks.add(name="carry0", seconds=0.5)
    line, score = in_words(status).splitlines()
    assert line.endswith("practice room")
    assert (
        score
        == "  arm0 Ana: reach0 3.2 s in 1 try, turn0 5.0 s in 2 tries, grip0 1.0 s in 1 try, carry0 open"
    )
    told = as_json(status)["course"]
    assert [(one["arm"], one["passed"]) for one in told] == [("arm0", False)]
    status.progress.subtasks[3].done = True
    assert in_words(status).endswith("passed in 9.7 s")
