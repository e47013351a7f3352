from mart.v1 import room_pb2 as _room_pb2
from mart.v1 import state_pb2 as _state_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RolloutRequest(_message.Message):
    __slots__ = ("reset", "step", "close", "resimulate", "describe", "compare_ticks")
    class Reset(_message.Message):
        __slots__ = ("task", "control_hz", "arms", "seeds", "integration_states", "arm_kinds")
        TASK_FIELD_NUMBER: _ClassVar[int]
        CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
        ARMS_FIELD_NUMBER: _ClassVar[int]
        SEEDS_FIELD_NUMBER: _ClassVar[int]
        INTEGRATION_STATES_FIELD_NUMBER: _ClassVar[int]
        ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
        task: str
        control_hz: float
        arms: int
        seeds: _containers.RepeatedScalarFieldContainer[int]
        integration_states: bool
        arm_kinds: _containers.RepeatedScalarFieldContainer[str]
        def __init__(self, task: _Optional[str] = ..., control_hz: _Optional[float] = ..., arms: _Optional[int] = ..., seeds: _Optional[_Iterable[int]] = ..., integration_states: _Optional[bool] = ..., arm_kinds: _Optional[_Iterable[str]] = ...) -> None: ...
    class Step(_message.Message):
        __slots__ = ("session", "actions", "running", "number")
        SESSION_FIELD_NUMBER: _ClassVar[int]
        ACTIONS_FIELD_NUMBER: _ClassVar[int]
        RUNNING_FIELD_NUMBER: _ClassVar[int]
        NUMBER_FIELD_NUMBER: _ClassVar[int]
        session: str
        actions: bytes
        running: bytes
        number: int
        def __init__(self, session: _Optional[str] = ..., actions: _Optional[bytes] = ..., running: _Optional[bytes] = ..., number: _Optional[int] = ...) -> None: ...
    class Close(_message.Message):
        __slots__ = ("session",)
        SESSION_FIELD_NUMBER: _ClassVar[int]
        session: str
        def __init__(self, session: _Optional[str] = ...) -> None: ...
    class Resimulate(_message.Message):
        __slots__ = ("model_sha256", "task", "control_hz", "arms", "first_state", "actions", "native", "arm_kinds", "task_file", "mjb")
        MODEL_SHA256_FIELD_NUMBER: _ClassVar[int]
        TASK_FIELD_NUMBER: _ClassVar[int]
        CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
        ARMS_FIELD_NUMBER: _ClassVar[int]
        FIRST_STATE_FIELD_NUMBER: _ClassVar[int]
        ACTIONS_FIELD_NUMBER: _ClassVar[int]
        NATIVE_FIELD_NUMBER: _ClassVar[int]
        ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
        TASK_FILE_FIELD_NUMBER: _ClassVar[int]
        MJB_FIELD_NUMBER: _ClassVar[int]
        model_sha256: str
        task: str
        control_hz: float
        arms: int
        first_state: bytes
        actions: bytes
        native: bool
        arm_kinds: _containers.RepeatedScalarFieldContainer[str]
        task_file: bytes
        mjb: bytes
        def __init__(self, model_sha256: _Optional[str] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., arms: _Optional[int] = ..., first_state: _Optional[bytes] = ..., actions: _Optional[bytes] = ..., native: _Optional[bool] = ..., arm_kinds: _Optional[_Iterable[str]] = ..., task_file: _Optional[bytes] = ..., mjb: _Optional[bytes] = ...) -> None: ...
    class CompareTicks(_message.Message):
        __slots__ = ("model_sha256", "task", "control_hz", "arms", "states", "actions", "native", "arm_kinds", "task_file", "mjb")
        MODEL_SHA256_FIELD_NUMBER: _ClassVar[int]
        TASK_FIELD_NUMBER: _ClassVar[int]
        CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
        ARMS_FIELD_NUMBER: _ClassVar[int]
        STATES_FIELD_NUMBER: _ClassVar[int]
        ACTIONS_FIELD_NUMBER: _ClassVar[int]
        NATIVE_FIELD_NUMBER: _ClassVar[int]
        ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
        TASK_FILE_FIELD_NUMBER: _ClassVar[int]
        MJB_FIELD_NUMBER: _ClassVar[int]
        model_sha256: str
        task: str
        control_hz: float
        arms: int
        states: bytes
        actions: bytes
        native: bool
        arm_kinds: _containers.RepeatedScalarFieldContainer[str]
        task_file: bytes
        mjb: bytes
        def __init__(self, model_sha256: _Optional[str] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., arms: _Optional[int] = ..., states: _Optional[bytes] = ..., actions: _Optional[bytes] = ..., native: _Optional[bool] = ..., arm_kinds: _Optional[_Iterable[str]] = ..., task_file: _Optional[bytes] = ..., mjb: _Optional[bytes] = ...) -> None: ...
    class Describe(_message.Message):
        __slots__ = ("task", "control_hz", "arms", "arm_kinds")
        TASK_FIELD_NUMBER: _ClassVar[int]
        CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
        ARMS_FIELD_NUMBER: _ClassVar[int]
        ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
        task: str
        control_hz: float
        arms: int
        arm_kinds: _containers.RepeatedScalarFieldContainer[str]
        def __init__(self, task: _Optional[str] = ..., control_hz: _Optional[float] = ..., arms: _Optional[int] = ..., arm_kinds: _Optional[_Iterable[str]] = ...) -> None: ...
    RESET_FIELD_NUMBER: _ClassVar[int]
    STEP_FIELD_NUMBER: _ClassVar[int]
    CLOSE_FIELD_NUMBER: _ClassVar[int]
    RESIMULATE_FIELD_NUMBER: _ClassVar[int]
    DESCRIBE_FIELD_NUMBER: _ClassVar[int]
    COMPARE_TICKS_FIELD_NUMBER: _ClassVar[int]
    reset: RolloutRequest.Reset
    step: RolloutRequest.Step
    close: RolloutRequest.Close
    resimulate: RolloutRequest.Resimulate
    describe: RolloutRequest.Describe
    compare_ticks: RolloutRequest.CompareTicks
    def __init__(self, reset: _Optional[_Union[RolloutRequest.Reset, _Mapping]] = ..., step: _Optional[_Union[RolloutRequest.Step, _Mapping]] = ..., close: _Optional[_Union[RolloutRequest.Close, _Mapping]] = ..., resimulate: _Optional[_Union[RolloutRequest.Resimulate, _Mapping]] = ..., describe: _Optional[_Union[RolloutRequest.Describe, _Mapping]] = ..., compare_ticks: _Optional[_Union[RolloutRequest.CompareTicks, _Mapping]] = ...) -> None: ...

class StateDifference(_message.Message):
    __slots__ = ("group", "largest", "transition")
    GROUP_FIELD_NUMBER: _ClassVar[int]
    LARGEST_FIELD_NUMBER: _ClassVar[int]
    TRANSITION_FIELD_NUMBER: _ClassVar[int]
    group: str
    largest: float
    transition: int
    def __init__(self, group: _Optional[str] = ..., largest: _Optional[float] = ..., transition: _Optional[int] = ...) -> None: ...

class WorldArrays(_message.Message):
    __slots__ = ("observations", "subtasks", "success_ticks", "success", "failed", "sim_time_s", "integration_states")
    OBSERVATIONS_FIELD_NUMBER: _ClassVar[int]
    SUBTASKS_FIELD_NUMBER: _ClassVar[int]
    SUCCESS_TICKS_FIELD_NUMBER: _ClassVar[int]
    SUCCESS_FIELD_NUMBER: _ClassVar[int]
    FAILED_FIELD_NUMBER: _ClassVar[int]
    SIM_TIME_S_FIELD_NUMBER: _ClassVar[int]
    INTEGRATION_STATES_FIELD_NUMBER: _ClassVar[int]
    observations: bytes
    subtasks: bytes
    success_ticks: bytes
    success: bytes
    failed: _containers.RepeatedScalarFieldContainer[str]
    sim_time_s: bytes
    integration_states: bytes
    def __init__(self, observations: _Optional[bytes] = ..., subtasks: _Optional[bytes] = ..., success_ticks: _Optional[bytes] = ..., success: _Optional[bytes] = ..., failed: _Optional[_Iterable[str]] = ..., sim_time_s: _Optional[bytes] = ..., integration_states: _Optional[bytes] = ...) -> None: ...

class RolloutReply(_message.Message):
    __slots__ = ("error", "session", "worlds", "state_digests", "model", "numerics", "differences")
    ERROR_FIELD_NUMBER: _ClassVar[int]
    SESSION_FIELD_NUMBER: _ClassVar[int]
    WORLDS_FIELD_NUMBER: _ClassVar[int]
    STATE_DIGESTS_FIELD_NUMBER: _ClassVar[int]
    MODEL_FIELD_NUMBER: _ClassVar[int]
    NUMERICS_FIELD_NUMBER: _ClassVar[int]
    DIFFERENCES_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    session: str
    worlds: WorldArrays
    state_digests: bytes
    model: _state_pb2.Model
    numerics: _state_pb2.Numerics
    differences: _containers.RepeatedCompositeFieldContainer[StateDifference]
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., session: _Optional[str] = ..., worlds: _Optional[_Union[WorldArrays, _Mapping]] = ..., state_digests: _Optional[bytes] = ..., model: _Optional[_Union[_state_pb2.Model, _Mapping]] = ..., numerics: _Optional[_Union[_state_pb2.Numerics, _Mapping]] = ..., differences: _Optional[_Iterable[_Union[StateDifference, _Mapping]]] = ...) -> None: ...
