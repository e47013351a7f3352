"""Every message of the wire, importable from one place, with the helpers that turn them into domain values."""

from __future__ import annotations

import numpy as np

from mart.protocol.enum_words import (
    barrier_word,
    cue_from_word,
    cue_word,
    ended_by_word,
    job_state_word,
    operator_from_word,
    operator_word,
    outcome_from_word,
    outcome_word,
    phase_word,
)
from mart.protocol.errors import MartError, from_wire
from mart.protocol.pose import Pose
from mart.protocol.vocabulary import Verdict
from mart.v1.camera_pb2 import CameraFrame, CameraReport
from mart.v1.catalogue_pb2 import (
    CatalogueReply,
    CatalogueRequest,
    Edit,
    EditAct,
    EpisodeEdits,
    Lane,
    NamedDataSet,
    RecordedEpisode,
    RecordedView,
    Span,
    TickRange,
    TickTimes,
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
from mart.v1.driver_pb2 import (
    DRIVER_PHASE_FOLLOWING,
    DRIVER_PHASE_HOLDING,
    DRIVER_PHASE_STOPPED,
    ArmMeasured,
    ArmTarget,
    DriverHello,
    DriverPhase,
    DriverReply,
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
    DrivenArm,
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
    RoomCamera,
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
from mart.v1.voice_pb2 import VoicePacket

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
    "DRIVER_PHASE_FOLLOWING",
    "DRIVER_PHASE_HOLDING",
    "DRIVER_PHASE_STOPPED",
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
    "ArmMeasured",
    "ArmState",
    "ArmTarget",
    "BarrierPhase",
    "CameraFrame",
    "CameraReport",
    "CatalogueReply",
    "CatalogueRequest",
    "Command",
    "CommandStamps",
    "Cue",
    "Curve",
    "DataSet",
    "DrivenArm",
    "DriverHello",
    "DriverPhase",
    "DriverReply",
    "Edit",
    "EditAct",
    "EmergencyStop",
    "EndedBy",
    "Episode",
    "EpisodeEdits",
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
    "RoomCamera",
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
    "TickRange",
    "TickStamps",
    "TickTimes",
    "Trace",
    "TrainerReply",
    "TrainerRequest",
    "VoicePacket",
    "Waiting",
    "WorldArrays",
    "barrier_word",
    "cue_from_word",
    "cue_word",
    "ended_by_word",
    "error_message",
    "is_good",
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


def is_good(saved: Event.EpisodeSaved) -> bool:
    """Tell whether a saved episode counts as good: a success, verified or of real arms."""
    return saved.outcome == OUTCOME_SUCCESS and (saved.verified or saved.verdict == Verdict.REAL)


def error_message(error: MartError) -> Error:
    return Error(code=error.code, message=str(error))


def raise_error(error: Error) -> None:
    """Raise what the other side reported; do nothing where `error` is empty."""
    if error.code or error.message:
        raise from_wire(error.code, error.message)
