"""Who passes the practice course is told once, with the score, and only where they did all of it by themselves."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from mart.protocol.errors import Unavailable
from mart.protocol.holders import holder_tag
from mart.protocol.messages import (
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    RoomStatus,
    Seat,
)
from mart.protocol.practice import has_passed, stations_of
from mart.protocol.tasks import get_task, practice_course
from mart.web.lobby.passed_courses import PassedCourses


def course_status(*done: str) -> RoomStatus:
    """A course of two arms, Ana at the first, a script at the other; done: the stations that are."""
    task = get_task(practice_course.NAME)
    status = RoomStatus(room="room-2", task=task.name)
    tag = holder_tag("1", "arm0", 2, "ana")
    status.seats.append(Seat(arm="arm0", operator=OPERATOR_HUMAN, epoch=2, holder_tag=tag, name="Ana"))
    status.seats.append(Seat(arm="arm1", operator=OPERATOR_SCRIPT, epoch=1))
    status.episode.phase = EPISODE_PHASE_PRACTICE
    for subtask in task.subtasks:
        is_done = subtask.name in done
        status.progress.subtasks.add(
            name=subtask.name, done=is_done, seconds=2.0 * is_done, tries=int(is_done)
        )
    return status


ALL_OF_ANA = ("reach0", "turn0", "grip0", "carry0", practice_course.TOGETHER)


class Keeper:
    def __init__(self) -> None:
        self.kept: list[tuple[bool, bool, float, int]] = []
        self.full = False

    def keep(self, is_them: Callable[[str], bool], seconds: float, tries: int) -> None:
        if self.full:
            raise Unavailable("The disk is full.")
        self.kept.append((is_them("ana"), is_them("ben"), seconds, tries))


def test_whoever_is_through_all_stations_is_told_once() -> None:
    keeper = Keeper()
    courses = PassedCourses(keeper.keep)
    for done in (ALL_OF_ANA[:4], ALL_OF_ANA, ALL_OF_ANA):
        courses.see_status(course_status(*done))
    assert keeper.kept == [(True, False, 10.0, 5)]
    courses.see_status(course_status())  # begun anew
    courses.see_status(course_status(*ALL_OF_ANA))
    assert len(keeper.kept) == 2


def test_what_could_not_be_kept_is_told_again() -> None:
    keeper = Keeper()
    courses = PassedCourses(keeper.keep)
    keeper.full = True
    with pytest.raises(Unavailable):
        courses.see_status(course_status(*ALL_OF_ANA))
    keeper.full = False
    courses.see_status(course_status(*ALL_OF_ANA))
    assert len(keeper.kept) == 1


def test_scripts_do_not_pass_and_recordings_do_not_count() -> None:
    every = {subtask.name for subtask in get_task(practice_course.NAME).subtasks}
    status = course_status(*every)
    assert (has_passed(status, "arm0"), has_passed(status, "arm1")) == (True, False)
    status.episode.phase = EPISODE_PHASE_RECORDING  # a person may have taken over in the middle of it
    assert not has_passed(status, "arm0")


def test_another_task_has_no_stations() -> None:
    status = course_status(*ALL_OF_ANA)
    status.task = "two_arm_multi_cube_lifting"
    assert stations_of(status, "arm0") == ()
    assert not has_passed(status, "arm0")
