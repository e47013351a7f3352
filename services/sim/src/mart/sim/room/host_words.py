"""Do what a host says about a room itself: how many episodes are wanted, and whether the course is required. Pure."""

from __future__ import annotations

from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import EpisodeRequest, Event
from mart.sim.room.room_messages import notice
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.seats import require_name

MAX_PLANNED = 10_000  # good episodes


def hear_host(request: EpisodeRequest, record: SavedRoom, *, practice: bool) -> tuple[SavedRoom, Event]:
    """Return the room's record after a plan or a requirement, and the notice that tells everybody.

    practice: nothing is recorded in this room. Raises InvalidInput where the name cannot be shown or the episodes are
    too many, Conflict where a practice room has no use for it.
    """
    if practice:
        raise Conflict(
            "This is a practice room: nothing is recorded here, so there is nothing to plan or to require."
        )
    if request.HasField("set_plan"):
        said = _planned(request.set_plan)  # first: it refuses what no record can hold
        return record.with_host_plan(request.set_plan.episodes), said
    said = _required(request.require_course)
    return record.with_course_required(request.require_course.required), said


def _planned(wanted: EpisodeRequest.SetPlan) -> Event:
    require_name(wanted.name)
    if wanted.episodes > MAX_PLANNED:
        raise InvalidInput(f"{wanted.episodes} episodes were given; plan at most {MAX_PLANNED}, or none (0).")
    plan = f"{wanted.episodes} good episodes are" if wanted.episodes != 1 else "one good episode is"
    return notice(
        "info", f"{wanted.name}, the host, set the plan: {plan if wanted.episodes else 'none is'} wanted."
    )


def _required(said: EpisodeRequest.RequireCourse) -> Event:
    require_name(said.name)
    who = "who has passed the practice course" if said.required else "everybody"
    return notice("info", f"{said.name}, the host, lets {who} record here.")
