from __future__ import annotations

import math

import pytest

from mart.protocol import keys
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.holders import holder_tag
from mart.protocol.messages import (
    BARRIER_PHASE_STALLED,
    CUE_GO,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    OUTCOME_SUCCESS,
    Event,
    RoomStatus,
    Seat,
)
from mart.protocol.vocabulary import ServiceKind
from mart.web.lobby.lobby import Lobby
from mart.web.lobby.room_json import event_json
from mart.web.lobby.room_table import GONE_AFTER_S, SILENT_AFTER_S


def status(room: str = "room-1", task: str = "two_arm_multi_cube_lifting") -> RoomStatus:
    told = RoomStatus(room=room, task=task, control_hz=20.0, tick=7, real_time_factor=0.99)
    told.barrier = BARRIER_PHASE_STALLED
    tag = holder_tag("1", "arm0", 2, "secret")
    told.seats.append(Seat(arm="arm0", operator=OPERATOR_HUMAN, epoch=2, holder_tag=tag, name="Ana"))
    told.seats.append(Seat(arm="arm1", operator=OPERATOR_SCRIPT, epoch=3, kept_s=12.5))
    told.waiting_for.add(arm="arm0", since_s=0.8)
    told.episode.phase = EPISODE_PHASE_RECORDING
    told.progress.subtasks.add(name="lift_cube0", done=True)
    told.to_do["arm0"] = "Hold it."
    return told


def alive_lobby() -> Lobby:
    lobby = Lobby()
    lobby.see_alive(keys.alive(ServiceKind.SIM, "room-1"), True)
    return lobby


def lobby_with(*rooms: str, now_s: float = 0.0) -> Lobby:
    lobby = Lobby()
    for room in rooms:
        lobby.see_alive(keys.alive(ServiceKind.SIM, room), True)
        lobby.see_status(status(room), now_s)
    return lobby


def test_a_room_is_told_in_the_words_of_the_protocol() -> None:
    (room,) = lobby_with("room-1").rooms_json("secret", 0.1)
    assert room["title"] == "Multi-cube lifting"
    assert room["barrier"] == "stalled"
    assert room["waiting_for"] == [{"arm": "arm0", "name": "Ana", "since_s": 0.8}]
    assert room["episode"]["phase"] == "recording"
    assert room["to_do"] == {"arm0": "Hold it."}
    assert room["progress"]["subtasks"] == [
        {
            "name": "lift_cube0",
            "title": "The blue cube is up",
            "arms": ["arm0"],
            "done": True,
            "seconds": 0.0,
            "tries": 0,
        }
    ]
    assert room["time_limit_s"] > 0
    assert [seat["operator"] for seat in room["seats"]] == ["human", "script"]
    assert [seat["mine"] for seat in room["seats"]] == [True, False]
    assert room["plan"] is None
    assert [seat["kept_s"] for seat in room["seats"]] == [0.0, 12.5]


def test_a_stranger_never_sees_a_holder_id() -> None:
    for stranger in ("", "other"):
        (room,) = lobby_with("room-1").rooms_json(stranger, 0.1)
        assert "secret" not in str(room)
        assert not any(seat["mine"] for seat in room["seats"])


def test_rooms_are_ordered_by_name() -> None:
    rooms = lobby_with("room-2", "room-10", "room-1").rooms_json("", 0.0)
    assert [room["room"] for room in rooms] == ["room-1", "room-10", "room-2"]


def test_a_plan_is_told() -> None:
    told = status()
    told.plan.episodes = 50
    lobby = alive_lobby()
    lobby.see_status(told, 0.0)
    assert lobby.room_json("room-1", "", 0.0)["plan"] == {"episodes": 50, "good": 0}


def test_a_silent_room_is_stale() -> None:
    lobby = lobby_with("room-1")
    assert not lobby.room_json("room-1", "", SILENT_AFTER_S)["stale"]
    assert lobby.room_json("room-1", "", SILENT_AFTER_S + 0.1)["stale"]
    assert lobby.rooms_json("", 1000.0) != []


def test_a_silence_is_told_once() -> None:
    lobby = lobby_with("room-1", "room-2")
    changes = lobby.listeners.changes
    lobby.see_silence(SILENT_AFTER_S)
    assert lobby.listeners.changes == changes
    for _ in range(2):
        lobby.see_silence(SILENT_AFTER_S + 0.1)
        assert lobby.listeners.changes == changes + 1
    lobby.see_status(status("room-1"), 1.0)
    lobby.see_silence(1.0)
    changes = lobby.listeners.changes
    lobby.see_silence(1.1 + SILENT_AFTER_S)
    assert lobby.listeners.changes == changes + 1


def test_a_room_whose_sim_has_gone_is_stale_at_once_and_disappears() -> None:
    lobby = lobby_with("room-1")
    lobby.see_alive(keys.alive(ServiceKind.SIM, "room-1"), False)
    assert lobby.room_json("room-1", "", 0.1)["stale"]
    assert lobby.rooms_json("", GONE_AFTER_S) != []
    assert lobby.rooms_json("", GONE_AFTER_S + 0.1) == []
    with pytest.raises(NotFound):
        lobby.rooms.status("room-1", GONE_AFTER_S + 0.1)


def test_a_room_that_comes_back_is_whole_again() -> None:
    lobby = lobby_with("room-1")
    lobby.see_alive(keys.alive(ServiceKind.SIM, "room-1"), False)
    lobby.see_alive(keys.alive(ServiceKind.SIM, "room-1"), True)
    lobby.see_status(status(), 2.0)
    assert not lobby.room_json("room-1", "", 2.1)["stale"]


def test_a_task_that_this_service_does_not_know_is_shown_under_its_name() -> None:
    lobby = alive_lobby()
    lobby.see_status(status(task="three_arm_juggling"), 0.0)
    (room,) = lobby.rooms_json("", 0.0)
    assert (room["title"], room["instruction"], room["time_limit_s"]) == ("three_arm_juggling", "", None)


@pytest.mark.parametrize(
    ("kind", "said"), [("panda", "sponge"), ("panda+wiping_pad", "Green wipes"), ("theirs", "sponge")]
)
def test_what_is_to_be_done_is_said_for_the_arms_of_the_room(kind: str, said: str) -> None:
    lobby, told = alive_lobby(), status(task="three_arm_lift_wiping")
    told.seats.add(arm="arm2", operator=OPERATOR_SCRIPT)
    told.arm_kinds.extend(["panda", "ur5e", kind])
    lobby.see_status(told, 0.0)
    (room,) = lobby.rooms_json("", 0.0)
    assert said in room["instruction"]


def test_an_unknown_arm_is_not_found() -> None:
    with pytest.raises(NotFound):
        lobby_with("room-1").rooms.seat("room-1", "arm2", 0.0)


def test_a_saved_episode_is_told() -> None:
    event = Event(room="room-1")
    event.episode_saved.number = 3
    event.episode_saved.path = "episodes/2026-11-22/room-1-0003-x.mcap"
    event.episode_saved.outcome = OUTCOME_SUCCESS
    told = event_json(event)
    assert told is not None
    assert (told["kind"], told["number"], told["outcome"]) == ("episode_saved", 3, "success")


def test_a_cue_is_told() -> None:
    told = event_json(Event(room="room-1", cue_given=Event.CueGiven(arm="arm1", cue=CUE_GO)))
    assert told == {"room": "room-1", "kind": "cue_given", "arm": "arm1", "cue": "go"}


def test_a_notice_is_told() -> None:
    event = Event(room="room-1")
    event.notice.level, event.notice.text = "error", "The disk is full."
    told = event_json(event)
    assert told is not None
    assert (told["level"], told["text"]) == ("error", "The disk is full.")


def test_what_a_status_tells_better_is_left_out() -> None:
    event = Event(room="room-1")
    event.world_reset.seed = 1
    assert event_json(event) is None
    assert event_json(Event()) is None


def test_a_status_that_cannot_be_shown_is_refused_and_takes_no_other_along() -> None:
    lobby = lobby_with("room-1", "room-2")
    for number in (math.nan, math.inf):
        bad = status("room-2")
        bad.real_time_factor = number
        with pytest.raises(InvalidInput, match="room-2"):
            lobby.see_status(bad, 0.1)
    assert [room["room"] for room in lobby.rooms_json("", 0.2)] == ["room-1", "room-2"]
