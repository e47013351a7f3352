"""Say what goes together in a room for practice, in which nothing is recorded, and who has passed the course there."""

from __future__ import annotations

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import EPISODE_PHASE_PRACTICE, OPERATOR_HUMAN, RoomStatus, Subtask
from mart.protocol.tasks import get_task, practice_course


def require_practice_alone(
    *, practice: bool, course_required: bool, episodes: int, lockstep: bool = False
) -> None:
    """Raise InvalidInput where a room for practice is asked for what recordings are for.

    episodes: good ones that are wanted, 0: no plan.
    """
    against = {
        "the required course": course_required,
        "the wanted episodes": bool(episodes),
        "lockstep": lockstep,
    }
    what = " and ".join(words for words, asked in against.items() if asked)
    if practice and what:
        raise InvalidInput(
            f"A practice room records nothing: leave out {what}, or let it be no practice room."
        )


def stations_of(status: RoomStatus, arm: str) -> tuple[Subtask, ...]:
    """Return how an arm's stations of the practice course stand, the common one last; none of another task."""
    if status.task != practice_course.NAME:
        return ()
    task = get_task(status.task, len(status.seats) or None)
    own = {subtask.name for subtask in task.subtasks if arm in (subtask.arms or task.arm_names)}
    return tuple(station for station in status.progress.subtasks if station.name in own)


def has_passed(status: RoomStatus, arm: str) -> bool:
    """Whether the person at this arm has done all of its stations, and all of them by themselves.

    A room begins the course anew when somebody sits down, in practice: what is done was done by who sits there.
    """
    is_person = any(seat.arm == arm and seat.operator == OPERATOR_HUMAN for seat in status.seats)
    stations = stations_of(status, arm) if status.episode.phase == EPISODE_PHASE_PRACTICE else ()
    return is_person and bool(stations) and all(station.done for station in stations)
