"""Every message of the wire, importable from one place, with the helpers that turn them into domain values."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from mart.protocol.errors import InvalidInput, MartError, from_wire
from mart.protocol.pose import Pose
from mart.protocol.vocabulary import EpisodeEndedBy, EpisodeOutcome, OperatorKind
from mart.v1.catalogue_pb2 import (
    CatalogueReply,
    CatalogueRequest,
    Lane,
    NamedDataSet,
    RecordedEpisode,
    RecordedView,
    Span,
    Trace,
)
from mart.v1.command_pb2 import (
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    OPERATOR_UNSPECIFIED,
    Command,
    CommandStamps,
    Operator,
)
from mart.v1.pose_pb2 import Pose as PoseMessage
from mart.v1.rollout_pb2 import RolloutReply, RolloutRequest, StateDifference, WorldArrays
from mart.v1.room_pb2 import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    CUE_COME_CLOSER,
    CUE_GO,
    CUE_LET_GO,
    CUE_SLOWER,
    CUE_THANKS,
    CUE_WAIT,
    ENDED_BY_ABSENCE,
    ENDED_BY_OPERATOR,
    ENDED_BY_ROOM,
    ENDED_BY_TASK,
    ENDED_BY_TIME,
    ENDED_BY_UNSPECIFIED,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_DISCARDED,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    OUTCOME_UNSPECIFIED,
    BarrierPhase,
    Cue,
    EmergencyStop,
    EndedBy,
    Episode,
    EpisodePhase,
    EpisodeRequest,
    Error,
    Event,
    Outcome,
    Plan,
    RecordingReport,
    RoomReply,
    RoomsRequest,
    RoomStatus,
    Seat,
    SeatRequest,
    Waiting,
)
from mart.v1.signal_pb2 import Answer, Offer, OpenSeat, OpenSeatReply, SceneReply, SceneRequest
from mart.v1.state_pb2 import ArmState, Model, Numerics, Observation, Progress, State, Subtask, TickStamps
from mart.v1.trainer_pb2 import (
    JOB_STATE_CANCELLED,
    JOB_STATE_DONE,
    JOB_STATE_FAILED,
    JOB_STATE_QUEUED,
    JOB_STATE_RUNNING,
    Curve,
    DataSet,
    Evaluation,
    Job,
    JobProgress,
    JobState,
    Learned,
    Order,
    Policy,
    Rollout,
    SubtaskCount,
    TrainerReply,
    TrainerRequest,
)

__all__ = [
    "BARRIER_PHASE_PAUSED",
    "BARRIER_PHASE_RUNNING",
    "BARRIER_PHASE_STALLED",
    "BARRIER_PHASE_STOPPED",
    "CUE_COME_CLOSER",
    "CUE_GO",
    "CUE_LET_GO",
    "CUE_SLOWER",
    "CUE_THANKS",
    "CUE_WAIT",
    "ENDED_BY_ABSENCE",
    "ENDED_BY_OPERATOR",
    "ENDED_BY_ROOM",
    "ENDED_BY_TASK",
    "ENDED_BY_TIME",
    "ENDED_BY_UNSPECIFIED",
    "EPISODE_PHASE_COUNTDOWN",
    "EPISODE_PHASE_ENDED",
    "EPISODE_PHASE_PRACTICE",
    "EPISODE_PHASE_RECORDING",
    "JOB_STATE_CANCELLED",
    "JOB_STATE_DONE",
    "JOB_STATE_FAILED",
    "JOB_STATE_QUEUED",
    "JOB_STATE_RUNNING",
    "OPERATOR_HOLD",
    "OPERATOR_HUMAN",
    "OPERATOR_POLICY",
    "OPERATOR_SCRIPT",
    "OPERATOR_UNSPECIFIED",
    "OUTCOME_DISCARDED",
    "OUTCOME_FAILURE",
    "OUTCOME_SUCCESS",
    "OUTCOME_UNSPECIFIED",
    "Answer",
    "ArmState",
    "BarrierPhase",
    "CatalogueReply",
    "CatalogueRequest",
    "Command",
    "CommandStamps",
    "Cue",
    "Curve",
    "DataSet",
    "EmergencyStop",
    "EndedBy",
    "Episode",
    "EpisodePhase",
    "EpisodeRequest",
    "Error",
    "Evaluation",
    "Event",
    "Job",
    "JobProgress",
    "JobState",
    "Lane",
    "Learned",
    "Model",
    "NamedDataSet",
    "Numerics",
    "Observation",
    "Offer",
    "OpenSeat",
    "OpenSeatReply",
    "Operator",
    "Order",
    "Outcome",
    "Plan",
    "Policy",
    "PoseMessage",
    "Progress",
    "RecordedEpisode",
    "RecordedView",
    "RecordingReport",
    "Rollout",
    "RolloutReply",
    "RolloutRequest",
    "RoomReply",
    "RoomStatus",
    "RoomsRequest",
    "SceneReply",
    "SceneRequest",
    "Seat",
    "SeatRequest",
    "Span",
    "State",
    "StateDifference",
    "Subtask",
    "SubtaskCount",
    "TickStamps",
    "Trace",
    "TrainerReply",
    "TrainerRequest",
    "Waiting",
    "WorldArrays",
    "barrier_word",
    "cue_from_word",
    "cue_word",
    "ended_by_word",
    "error_message",
    "job_state_word",
    "operator_from_word",
    "operator_word",
    "outcome_from_word",
    "outcome_word",
    "phase_word",
    "pose_from_message",
    "pose_message",
    "raise_error",
]


def pose_message(pose: Pose) -> PoseMessage:
    x, y, z = pose.position.tolist()
    qw, qx, qy, qz = pose.quaternion_wxyz.tolist()
    return PoseMessage(x=x, y=y, z=z, qw=qw, qx=qx, qy=qy, qz=qz)


def pose_from_message(message: PoseMessage) -> Pose:
    """Return the pose. Raises InvalidInput where a number is not finite or the quaternion is not of unit norm."""
    return Pose(
        np.array([message.x, message.y, message.z]),
        np.array([message.qw, message.qx, message.qy, message.qz]),
    )


def error_message(error: MartError) -> Error:
    return Error(code=error.code, message=str(error))


def raise_error(error: Error) -> None:
    """Raise what the other side reported; do nothing where `error` is empty."""
    if error.code or error.message:
        raise from_wire(error.code, error.message)


def operator_word(operator: Operator) -> OperatorKind:
    """Return the word for a member of the wire's enum: human, policy, script or hold."""
    return OperatorKind(_word(Operator.Name(operator), "OPERATOR_"))


def outcome_word(outcome: Outcome) -> EpisodeOutcome:
    """Return the word for a member of the wire's enum: success, failure, discarded or unspecified."""
    return EpisodeOutcome(_word(Outcome.Name(outcome), "OUTCOME_"))


def phase_word(phase: EpisodePhase) -> str:
    """Return the word for a phase: practice, countdown, recording or ended."""
    return _word(EpisodePhase.Name(phase), "EPISODE_PHASE_")


def barrier_word(phase: BarrierPhase) -> str:
    """Return the word for the barrier's phase: running, stalled, paused or stopped."""
    return _word(BarrierPhase.Name(phase), "BARRIER_PHASE_")


def job_state_word(state: JobState) -> str:
    """Return the word for a job's state: queued, running, done, failed or cancelled."""
    return _word(JobState.Name(state), "JOB_STATE_")


def cue_word(cue: Cue) -> str:
    """Return the word for a cue: have_it, go, wait, slower, thanks, let_go or come_closer."""
    return _word(Cue.Name(cue), "CUE_")


def ended_by_word(ended_by: EndedBy) -> EpisodeEndedBy | None:
    """Return the word for what ended an episode, None where nothing says so."""
    if ended_by == ENDED_BY_UNSPECIFIED:
        return None
    return EpisodeEndedBy(_word(EndedBy.Name(ended_by), "ENDED_BY_"))


def operator_from_word(word: str) -> Operator:
    """Return the wire's member. Raises InvalidInput for anything but human, policy, script or hold."""
    return cast("Operator", _value(Operator, "OPERATOR_", "Operator", word))


def outcome_from_word(word: str) -> Outcome:
    """Return the wire's member. Raises InvalidInput for anything but success, failure or discarded."""
    return cast("Outcome", _value(Outcome, "OUTCOME_", "Outcome", word))


def cue_from_word(word: str) -> Cue:
    """Return the wire's member. Raises InvalidInput for any word that `cue_word` does not return."""
    return cast("Cue", _value(Cue, "CUE_", "Cue", word))


def _value(enum: Any, prefix: str, what: str, word: str) -> int:
    """Of any member but the first, which says nothing."""
    *words, last = (_word(name, prefix) for name in enum.keys()[1:])
    if word not in (*words, last):
        raise InvalidInput(f"{what} {word!r} was given; it must be {', '.join(words)} or {last}.")
    value: int = enum.Value(prefix + word.upper())
    return value


def _word(name: str, prefix: str) -> str:
    return name.removeprefix(prefix).lower()
