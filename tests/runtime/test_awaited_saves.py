from __future__ import annotations

from mart.protocol.messages import (
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    EpisodePhase,
    RoomStatus,
)
from mart.runtime.awaited_saves import ASKED_AFTER_S, ASKED_EVERY_S, GIVEN_UP_AFTER_S, AwaitedSaves


def seen(saves: AwaitedSaves, phase: EpisodePhase, number: int, now_s: float, room: str = "room-1") -> None:
    status = RoomStatus(room=room, wall_ns=7)
    status.episode.phase, status.episode.number = phase, number
    saves.see_status(status, now_s)


def due(saves: AwaitedSaves, now_s: float) -> list[tuple[str, int]]:
    return [(save.room, save.number) for save in saves.take_due(now_s)]


def test_an_episode_that_ended_without_a_word_of_its_file_is_asked_for_again_and_again() -> None:
    saves = AwaitedSaves()
    seen(saves, EPISODE_PHASE_RECORDING, 3, 0.0)
    assert due(saves, 100.0) == []
    seen(saves, EPISODE_PHASE_ENDED, 3, 100.0)
    assert due(saves, 100.0) == []
    assert due(saves, 100.0 + ASKED_AFTER_S) == [("room-1", 3)]
    assert due(saves, 100.1 + ASKED_AFTER_S) == []
    assert due(saves, 100.1 + ASKED_AFTER_S + ASKED_EVERY_S) == [("room-1", 3)]
    assert due(saves, 100.0 + GIVEN_UP_AFTER_S) == []


def test_whose_file_was_heard_of_is_not_asked_for() -> None:
    saves = AwaitedSaves()
    seen(saves, EPISODE_PHASE_RECORDING, 3, 0.0)
    seen(saves, EPISODE_PHASE_ENDED, 3, 1.0)
    saves.see_saved("room-1", 3)
    seen(saves, EPISODE_PHASE_ENDED, 3, 1.2)
    assert due(saves, 60.0) == []


def test_an_end_that_nobody_saw_is_known_by_what_came_after_it() -> None:
    saves = AwaitedSaves()
    seen(saves, EPISODE_PHASE_RECORDING, 3, 0.0)
    seen(saves, EPISODE_PHASE_RECORDING, 4, 1.0)
    seen(saves, EPISODE_PHASE_PRACTICE, 4, 2.0)
    assert due(saves, 60.0) == [("room-1", 3), ("room-1", 4)]


def test_who_comes_while_an_episode_ends_awaits_it_and_who_comes_later_does_not() -> None:
    saves = AwaitedSaves()
    seen(saves, EPISODE_PHASE_ENDED, 3, 0.0)
    seen(saves, EPISODE_PHASE_PRACTICE, 9, 0.0, room="room-2")
    assert due(saves, 60.0) == [("room-1", 3)]


def test_memory_is_bounded() -> None:
    saves = AwaitedSaves()
    for number in range(1, 1000):
        seen(saves, EPISODE_PHASE_RECORDING, number, 0.0, room=f"room-{number}")
        seen(saves, EPISODE_PHASE_RECORDING, number + 1, 0.0, room=f"room-{number}")
    assert len(due(saves, 60.0)) == 64
    assert len(saves._recording) == 256
