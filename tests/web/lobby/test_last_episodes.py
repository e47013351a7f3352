from __future__ import annotations

from typing import Any

from mart.protocol.messages import (
    ENDED_BY_OPERATOR,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_DISCARDED,
    OUTCOME_FAILURE,
    EpisodePhase,
    Event,
    RoomStatus,
    Seat,
)
from mart.web.lobby.last_episodes import LastEpisodes

ROOM, SEATS = "room-1", [Seat(arm="arm0", epoch=3)]


def status(phase: EpisodePhase, number: int = 4, reason: str = "") -> RoomStatus:
    told = RoomStatus(room=ROOM, seats=SEATS)
    told.episode.phase, told.episode.number, told.episode.reason = phase, number, reason
    if phase == EPISODE_PHASE_ENDED:
        told.episode.outcome = OUTCOME_FAILURE
    return told


def saved(number: int = 4) -> Event.EpisodeSaved:
    path = f"episodes/{ROOM}/{number}.mcap"
    return Event.EpisodeSaved(number=number, path=path, verified=True, outcome=OUTCOME_FAILURE)


def after(*phases: EpisodePhase) -> LastEpisodes:
    episodes = LastEpisodes()
    for phase in phases:
        episodes.see_status(status(phase, reason="time is up"), 10.0)
    return episodes


def told(episodes: LastEpisodes, now_s: float = 10.0) -> dict[str, Any]:
    last = episodes.json(ROOM, now_s)
    assert last is not None
    return last


def test_an_episode_is_told_from_its_end_until_the_next_one_begins() -> None:
    episodes = after(EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED, EPISODE_PHASE_PRACTICE)
    last = told(episodes, 12.5)
    assert (last["number"], last["outcome"], last["reason"]) == (4, "failure", "time is up")
    assert (last["since_s"], last["epochs"], last["saved"]) == (2.5, {"arm0": 3}, None)
    episodes.see_saved(ROOM, saved(), SEATS, 13.0)
    assert told(episodes)["saved"]["path"] == "episodes/room-1/4.mcap"
    assert told(episodes)["reason"] == "time is up"
    episodes.see_status(status(EPISODE_PHASE_COUNTDOWN, 5), 20.0)
    assert episodes.json(ROOM, 20.0) is None


def test_a_recording_that_is_gone_without_a_word_was_interrupted() -> None:
    last = told(after(EPISODE_PHASE_RECORDING, EPISODE_PHASE_PRACTICE))
    assert (last["number"], last["outcome"], last["reason"]) == (4, "unspecified", "")


def test_who_ended_it_and_how_far_it_had_come_is_told() -> None:
    ended = status(EPISODE_PHASE_PRACTICE)
    ended.last_ended.number, ended.last_ended.reason = 4, "reset by Ana"
    ended.last_ended.outcome, ended.last_ended.ended_by = OUTCOME_DISCARDED, ENDED_BY_OPERATOR
    ended.last_ended.subtasks_done, ended.last_ended.subtasks = 1, 3
    episodes = after(EPISODE_PHASE_RECORDING)
    episodes.see_status(ended, 10.0)
    last = told(episodes)
    assert (last["outcome"], last["reason"], last["ended_by"]) == ("discarded", "reset by Ana", "operator")
    assert (last["subtasks_done"], last["subtasks"]) == (1, 3)
    ended.last_ended.number = 3  # of the one before
    episodes = after(EPISODE_PHASE_RECORDING)
    episodes.see_status(ended, 10.0)
    assert (told(episodes)["outcome"], told(episodes)["ended_by"]) == ("unspecified", "")


def test_practice_alone_tells_of_nothing() -> None:
    assert after(EPISODE_PHASE_PRACTICE).json(ROOM, 10.0) is None


def test_the_file_of_an_older_episode_is_not_told_in_the_place_of_a_newer_one() -> None:
    episodes = after(EPISODE_PHASE_RECORDING)
    episodes.see_saved(ROOM, saved(3), SEATS, 10.0)
    assert episodes.json(ROOM, 10.0) is None
    episodes = after(EPISODE_PHASE_ENDED)
    episodes.see_saved(ROOM, saved(3), SEATS, 10.0)
    assert told(episodes)["number"] == 4


def test_a_label_holds_also_where_the_verdict_comes_later() -> None:
    episodes = after(EPISODE_PHASE_ENDED)
    file = saved()
    file.outcome = OUTCOME_DISCARDED
    episodes.see_saved(ROOM, file, SEATS, 11.0)
    assert told(episodes)["outcome"] == "discarded"
    episodes.see_label("room-1/4.mcap", "failure")
    episodes.see_saved(ROOM, file, SEATS, 12.0)
    assert told(episodes)["outcome"] == "failure"


def test_rooms_are_forgotten_as_others_come() -> None:
    episodes = LastEpisodes()
    for number in range(300):
        room = RoomStatus(room=f"room-{number}")
        room.episode.phase, room.episode.number = EPISODE_PHASE_ENDED, 1
        episodes.see_status(room, 0.0)
    assert episodes.json("room-0", 0.0) is None
    assert episodes.json("room-299", 0.0) is not None
