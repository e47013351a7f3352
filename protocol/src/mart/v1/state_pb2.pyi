from mart.v1 import command_pb2 as _command_pb2
from mart.v1 import pose_pb2 as _pose_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class TickStamps(_message.Message):
    __slots__ = ("due_ns", "fired_ns", "stepped_ns", "sent_ns")
    DUE_NS_FIELD_NUMBER: _ClassVar[int]
    FIRED_NS_FIELD_NUMBER: _ClassVar[int]
    STEPPED_NS_FIELD_NUMBER: _ClassVar[int]
    SENT_NS_FIELD_NUMBER: _ClassVar[int]
    due_ns: int
    fired_ns: int
    stepped_ns: int
    sent_ns: int
    def __init__(self, due_ns: _Optional[int] = ..., fired_ns: _Optional[int] = ..., stepped_ns: _Optional[int] = ..., sent_ns: _Optional[int] = ...) -> None: ...

class ArmState(_message.Message):
    __slots__ = ("arm", "tool_in_base", "gripper", "action", "sequence", "arrived_ns", "stamps", "source", "seat_epoch", "engaged", "fresh", "measured", "measured_age_s")
    ARM_FIELD_NUMBER: _ClassVar[int]
    TOOL_IN_BASE_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_FIELD_NUMBER: _ClassVar[int]
    ACTION_FIELD_NUMBER: _ClassVar[int]
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    ARRIVED_NS_FIELD_NUMBER: _ClassVar[int]
    STAMPS_FIELD_NUMBER: _ClassVar[int]
    SOURCE_FIELD_NUMBER: _ClassVar[int]
    SEAT_EPOCH_FIELD_NUMBER: _ClassVar[int]
    ENGAGED_FIELD_NUMBER: _ClassVar[int]
    FRESH_FIELD_NUMBER: _ClassVar[int]
    MEASURED_FIELD_NUMBER: _ClassVar[int]
    MEASURED_AGE_S_FIELD_NUMBER: _ClassVar[int]
    arm: str
    tool_in_base: _pose_pb2.Pose
    gripper: float
    action: _containers.RepeatedScalarFieldContainer[float]
    sequence: int
    arrived_ns: int
    stamps: _command_pb2.CommandStamps
    source: _command_pb2.Operator
    seat_epoch: int
    engaged: bool
    fresh: bool
    measured: bool
    measured_age_s: float
    def __init__(self, arm: _Optional[str] = ..., tool_in_base: _Optional[_Union[_pose_pb2.Pose, _Mapping]] = ..., gripper: _Optional[float] = ..., action: _Optional[_Iterable[float]] = ..., sequence: _Optional[int] = ..., arrived_ns: _Optional[int] = ..., stamps: _Optional[_Union[_command_pb2.CommandStamps, _Mapping]] = ..., source: _Optional[_Union[_command_pb2.Operator, str]] = ..., seat_epoch: _Optional[int] = ..., engaged: _Optional[bool] = ..., fresh: _Optional[bool] = ..., measured: _Optional[bool] = ..., measured_age_s: _Optional[float] = ...) -> None: ...

class Observation(_message.Message):
    __slots__ = ("name", "value")
    NAME_FIELD_NUMBER: _ClassVar[int]
    VALUE_FIELD_NUMBER: _ClassVar[int]
    name: str
    value: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, name: _Optional[str] = ..., value: _Optional[_Iterable[float]] = ...) -> None: ...

class Subtask(_message.Message):
    __slots__ = ("name", "done", "seconds", "tries")
    NAME_FIELD_NUMBER: _ClassVar[int]
    DONE_FIELD_NUMBER: _ClassVar[int]
    SECONDS_FIELD_NUMBER: _ClassVar[int]
    TRIES_FIELD_NUMBER: _ClassVar[int]
    name: str
    done: bool
    seconds: float
    tries: int
    def __init__(self, name: _Optional[str] = ..., done: _Optional[bool] = ..., seconds: _Optional[float] = ..., tries: _Optional[int] = ...) -> None: ...

class Progress(_message.Message):
    __slots__ = ("subtasks", "success_now", "success_ticks", "success", "failed")
    SUBTASKS_FIELD_NUMBER: _ClassVar[int]
    SUCCESS_NOW_FIELD_NUMBER: _ClassVar[int]
    SUCCESS_TICKS_FIELD_NUMBER: _ClassVar[int]
    SUCCESS_FIELD_NUMBER: _ClassVar[int]
    FAILED_FIELD_NUMBER: _ClassVar[int]
    subtasks: _containers.RepeatedCompositeFieldContainer[Subtask]
    success_now: bool
    success_ticks: int
    success: bool
    failed: str
    def __init__(self, subtasks: _Optional[_Iterable[_Union[Subtask, _Mapping]]] = ..., success_now: _Optional[bool] = ..., success_ticks: _Optional[int] = ..., success: _Optional[bool] = ..., failed: _Optional[str] = ...) -> None: ...

class State(_message.Message):
    __slots__ = ("room", "tick", "sim_time_s", "stamps", "real_time_factor", "integration_state", "arms", "straggler", "straggler_late_s", "observations", "progress", "episode", "episode_tick", "boot")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    TICK_FIELD_NUMBER: _ClassVar[int]
    SIM_TIME_S_FIELD_NUMBER: _ClassVar[int]
    STAMPS_FIELD_NUMBER: _ClassVar[int]
    REAL_TIME_FACTOR_FIELD_NUMBER: _ClassVar[int]
    INTEGRATION_STATE_FIELD_NUMBER: _ClassVar[int]
    ARMS_FIELD_NUMBER: _ClassVar[int]
    STRAGGLER_FIELD_NUMBER: _ClassVar[int]
    STRAGGLER_LATE_S_FIELD_NUMBER: _ClassVar[int]
    OBSERVATIONS_FIELD_NUMBER: _ClassVar[int]
    PROGRESS_FIELD_NUMBER: _ClassVar[int]
    EPISODE_FIELD_NUMBER: _ClassVar[int]
    EPISODE_TICK_FIELD_NUMBER: _ClassVar[int]
    BOOT_FIELD_NUMBER: _ClassVar[int]
    room: str
    tick: int
    sim_time_s: float
    stamps: TickStamps
    real_time_factor: float
    integration_state: bytes
    arms: _containers.RepeatedCompositeFieldContainer[ArmState]
    straggler: str
    straggler_late_s: float
    observations: _containers.RepeatedCompositeFieldContainer[Observation]
    progress: Progress
    episode: int
    episode_tick: int
    boot: int
    def __init__(self, room: _Optional[str] = ..., tick: _Optional[int] = ..., sim_time_s: _Optional[float] = ..., stamps: _Optional[_Union[TickStamps, _Mapping]] = ..., real_time_factor: _Optional[float] = ..., integration_state: _Optional[bytes] = ..., arms: _Optional[_Iterable[_Union[ArmState, _Mapping]]] = ..., straggler: _Optional[str] = ..., straggler_late_s: _Optional[float] = ..., observations: _Optional[_Iterable[_Union[Observation, _Mapping]]] = ..., progress: _Optional[_Union[Progress, _Mapping]] = ..., episode: _Optional[int] = ..., episode_tick: _Optional[int] = ..., boot: _Optional[int] = ...) -> None: ...

class Model(_message.Message):
    __slots__ = ("sha256", "mjb", "task", "control_hz", "arms", "mujoco_version", "numerics", "arm_kinds", "task_file")
    SHA256_FIELD_NUMBER: _ClassVar[int]
    MJB_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    ARMS_FIELD_NUMBER: _ClassVar[int]
    MUJOCO_VERSION_FIELD_NUMBER: _ClassVar[int]
    NUMERICS_FIELD_NUMBER: _ClassVar[int]
    ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
    TASK_FILE_FIELD_NUMBER: _ClassVar[int]
    sha256: str
    mjb: bytes
    task: str
    control_hz: float
    arms: _containers.RepeatedScalarFieldContainer[str]
    mujoco_version: str
    numerics: Numerics
    arm_kinds: _containers.RepeatedScalarFieldContainer[str]
    task_file: bytes
    def __init__(self, sha256: _Optional[str] = ..., mjb: _Optional[bytes] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., arms: _Optional[_Iterable[str]] = ..., mujoco_version: _Optional[str] = ..., numerics: _Optional[_Union[Numerics, _Mapping]] = ..., arm_kinds: _Optional[_Iterable[str]] = ..., task_file: _Optional[bytes] = ...) -> None: ...

class Numerics(_message.Message):
    __slots__ = ("processor", "libm", "mujoco_build", "fingerprint")
    PROCESSOR_FIELD_NUMBER: _ClassVar[int]
    LIBM_FIELD_NUMBER: _ClassVar[int]
    MUJOCO_BUILD_FIELD_NUMBER: _ClassVar[int]
    FINGERPRINT_FIELD_NUMBER: _ClassVar[int]
    processor: str
    libm: str
    mujoco_build: str
    fingerprint: str
    def __init__(self, processor: _Optional[str] = ..., libm: _Optional[str] = ..., mujoco_build: _Optional[str] = ..., fingerprint: _Optional[str] = ...) -> None: ...
