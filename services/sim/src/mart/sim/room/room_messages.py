"""Build the messages that a room says: states, status and events. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mart.protocol.holders import holder_tag
from mart.protocol.messages import (
    OPERATOR_UNSPECIFIED,
    BarrierPhase,
    Episode,
    Event,
    Plan,
    Seat,
    SeatRequest,
    Waiting,
)
from mart.protocol.tasks import gripper_observation
from mart.sim.room.barrier import FREED_AFTER_S
from mart.sim.room.command_validation import ReceivedCommand
from mart.sim.room.episode_state_machine import BeginEpisode, EndEpisode, EpisodeStateMachine, Terms
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.seats import SeatHolder
from mart.sim.world import TaskProgress, World
from mart.sim.world.progress import Score

# What any operator sees, by name: see mart.protocol.tasks.
Seen = Mapping[str, NDArray[np.float64]]

# The fields of a message. Protobuf fills a mapping in place, a message it serialises and parses once more; on the way
# of every tick that is worth 40 %.
Fields = dict[str, Any]


def arm_state(
    seen: Seen, seat: SeatHolder, received: ReceivedCommand | None, action: Sequence[float]
) -> Fields:
    """Return the fields of an ArmState: one arm after a tick.

    received: the command that moved it, None for a held arm. action: empty after a reset.
    """
    x, y, z = seen[f"{seat.arm}/tool_position_in_base"].tolist()
    qw, qx, qy, qz = seen[f"{seat.arm}/tool_quaternion_in_base"].tolist()
    gripper = seen.get(gripper_observation(seat.arm))
    state: Fields = {
        "arm": seat.arm,
        "tool_in_base": {"x": x, "y": y, "z": z, "qw": qw, "qx": qx, "qy": qy, "qz": qz},
        "gripper": 0.0 if gripper is None else gripper.item(),  # none of an arm without fingers
        "action": action,
        "source": seat.operator,
        "seat_epoch": seat.epoch,
    }
    if received is not None:
        state.update(
            sequence=received.sequence,
            arrived_ns=received.at_wall_ns,
            stamps=received.command.stamps,
            engaged=received.command.engaged,
            fresh=True,
        )
    return state


def observations(seen: Seen) -> list[Fields]:
    """Return the fields of each Observation."""
    return [{"name": name, "value": value.ravel().tolist()} for name, value in seen.items()]


def progress(progress: TaskProgress) -> Fields:
    """Return the fields of a Progress message."""
    return {
        "subtasks": [
            {"name": name, "done": done, **_score(progress.scores.get(name))}
            for name, done in progress.subtasks.items()
        ],
        "success_now": progress.success_now,
        "success_ticks": progress.success_ticks,
        "success": progress.success,
        "failed": progress.failed or "",
    }


def _score(score: Score | None) -> Fields:
    return {} if score is None else {"seconds": score.seconds, "tries": score.tries}


def to_do(world: World, progress: TaskProgress) -> dict[str, str]:
    """Return by arm what its operator is to do now, where the task says so."""
    lines = {arm: world.to_do(arm, progress) for arm in world.arms}
    return {arm: line for arm, line in lines.items() if line}


def seat(holder: SeatHolder, ready: bool, newest: ReceivedCommand | None, salt: str, kept_s: float) -> Seat:
    """Return the message of a seat.

    newest: the newest command of its operator. salt: of its holder's tag. kept_s: see `Seat.kept_s`.
    """
    return Seat(
        arm=holder.arm,
        operator=holder.operator,
        epoch=holder.epoch,
        holder_tag=holder_tag(salt, holder.arm, holder.epoch, holder.holder_id),
        name=holder.name,
        ready=ready,
        engaged=newest is not None and newest.command.engaged,
        policy=holder.driver.policy,
        relieved=holder.relieved.called if holder.relieved else "",
        relieved_operator=holder.relieved.operator if holder.relieved else OPERATOR_UNSPECIFIED,
        kept_s=kept_s,
        passed_course=holder.passed_course,
    )


def episode(episode: EpisodeStateMachine, control_period_s: float, now_s: float) -> Episode:
    """Return the message of where the episode stands."""
    return Episode(
        number=episode.number,
        phase=episode.phase,
        remaining_s=episode.remaining_s(now_s),
        ticks=episode.ticks,
        elapsed_s=episode.ticks * control_period_s,
        outcome=episode.outcome,
        seed=episode.seed,
        interrupted=episode.interrupted,
        reason=episode.reason,
        ended_by=episode.ender.by,
        ended_by_name=episode.ender.name,
        ended_by_arm=episode.ender.arm,
    )


def episode_ended(effect: EndEpisode, last_tick: int, progress: TaskProgress | None) -> Event.EpisodeEnded:
    """Return what is said of an episode that has ended. progress: of the task in the last state."""
    subtasks = progress.subtasks if progress is not None else {}
    return Event.EpisodeEnded(
        number=effect.number,
        outcome=effect.outcome,
        ticks=effect.ticks,
        reason=effect.reason,
        last_tick=last_tick,
        ended_by=effect.ender.by,
        ended_by_name=effect.ender.name,
        ended_by_arm=effect.ender.arm,
        subtasks_done=sum(subtasks.values()),
        subtasks=len(subtasks),
    )


def counts(record: SavedRoom) -> Fields:
    """Return the fields of a RoomStatus that come from what a room keeps: episodes, the plan, whom it lets record."""
    wanted = record.plan
    plan = Plan(episodes=wanted.episodes, good=record.good - wanted.good_before) if wanted else None
    return {
        "episodes_saved": record.saved,
        "episodes_good": record.good,
        "plan": plan,
        "course_required": record.course_required,
    }


def waiting(arms: Iterable[tuple[str, float]]) -> list[Waiting]:
    """Return the arms that are waited for, and for how many seconds."""
    return [Waiting(arm=arm, since_s=since_s) for arm, since_s in arms]


def barrier_changed(phase: BarrierPhase, arms: Iterable[tuple[str, float]]) -> Event:
    """Return the event of a new barrier phase."""
    return Event(barrier_changed=Event.BarrierChanged(phase=phase, waiting_for=waiting(arms)))


def notice(level: str, text: str) -> Event:
    """Return an event that people read; `level`: info, warning or error."""
    event = Event()
    event.notice.level, event.notice.text = level, text
    setattr(event.notice, "from", "sim")  # a keyword in Python
    return event


def gave_up(seat: SeatHolder) -> Event:
    """Return the notice that somebody who went silent loses a seat."""
    text = f"{seat.driver.called} gave no command for {FREED_AFTER_S:g} s: {seat.arm} is free."
    return notice("warning", text)


def freed(free: SeatRequest.Free) -> Event:
    """Return the notice that a host freed a seat."""
    return notice("warning", f"{free.name}, the host, freed {free.arm}.")


def episode_started(
    effect: BeginEpisode,
    seats: Iterable[Seat],
    world: World,
    terms: Terms,
    time_limit_s: float,
) -> Event:
    """Return the event of an episode that begins."""
    started = Event.EpisodeStarted(
        number=effect.number,
        seed=effect.seed,
        seats=seats,
        task=world.task.name,
        control_hz=world.control_hz,
        model_sha256=world.model_sha256,
        lockstep=terms.lockstep,
        skill=terms.skill,
        time_limit_s=time_limit_s,
        captured_cameras=terms.cameras,
    )
    return Event(episode_started=started)


def old_commands(seat: SeatHolder, limit_ticks: int) -> Event:
    """Return the event that tells people why a seat's commands are refused."""
    return notice(
        "warning",
        f"{seat.driver.called} at {seat.arm} does not hear the room: commands made from a state more than "
        f"{limit_ticks} ticks old are refused.",
    )
