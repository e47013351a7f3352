from mart.v1 import pose_pb2 as _pose_pb2
from mart.v1 import room_pb2 as _room_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class DriverPhase(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    DRIVER_PHASE_UNSPECIFIED: _ClassVar[DriverPhase]
    DRIVER_PHASE_HOLDING: _ClassVar[DriverPhase]
    DRIVER_PHASE_FOLLOWING: _ClassVar[DriverPhase]
    DRIVER_PHASE_STOPPED: _ClassVar[DriverPhase]
DRIVER_PHASE_UNSPECIFIED: DriverPhase
DRIVER_PHASE_HOLDING: DriverPhase
DRIVER_PHASE_FOLLOWING: DriverPhase
DRIVER_PHASE_STOPPED: DriverPhase

class ArmTarget(_message.Message):
    __slots__ = ("room", "arm", "boot", "session", "sequence", "tick", "control_hz", "target_tool_in_base", "gripper", "engaged", "stop")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    ARM_FIELD_NUMBER: _ClassVar[int]
    BOOT_FIELD_NUMBER: _ClassVar[int]
    SESSION_FIELD_NUMBER: _ClassVar[int]
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    TICK_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    TARGET_TOOL_IN_BASE_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_FIELD_NUMBER: _ClassVar[int]
    ENGAGED_FIELD_NUMBER: _ClassVar[int]
    STOP_FIELD_NUMBER: _ClassVar[int]
    room: str
    arm: str
    boot: int
    session: int
    sequence: int
    tick: int
    control_hz: float
    target_tool_in_base: _pose_pb2.Pose
    gripper: float
    engaged: bool
    stop: bool
    def __init__(self, room: _Optional[str] = ..., arm: _Optional[str] = ..., boot: _Optional[int] = ..., session: _Optional[int] = ..., sequence: _Optional[int] = ..., tick: _Optional[int] = ..., control_hz: _Optional[float] = ..., target_tool_in_base: _Optional[_Union[_pose_pb2.Pose, _Mapping]] = ..., gripper: _Optional[float] = ..., engaged: _Optional[bool] = ..., stop: _Optional[bool] = ...) -> None: ...

class ArmMeasured(_message.Message):
    __slots__ = ("room", "arm", "session", "sequence", "joint_positions", "tool_in_base", "gripper", "phase", "fault", "reason", "age_s", "follows_tick")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    ARM_FIELD_NUMBER: _ClassVar[int]
    SESSION_FIELD_NUMBER: _ClassVar[int]
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    JOINT_POSITIONS_FIELD_NUMBER: _ClassVar[int]
    TOOL_IN_BASE_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_FIELD_NUMBER: _ClassVar[int]
    PHASE_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    AGE_S_FIELD_NUMBER: _ClassVar[int]
    FOLLOWS_TICK_FIELD_NUMBER: _ClassVar[int]
    room: str
    arm: str
    session: int
    sequence: int
    joint_positions: _containers.RepeatedScalarFieldContainer[float]
    tool_in_base: _pose_pb2.Pose
    gripper: float
    phase: DriverPhase
    fault: str
    reason: str
    age_s: float
    follows_tick: int
    def __init__(self, room: _Optional[str] = ..., arm: _Optional[str] = ..., session: _Optional[int] = ..., sequence: _Optional[int] = ..., joint_positions: _Optional[_Iterable[float]] = ..., tool_in_base: _Optional[_Union[_pose_pb2.Pose, _Mapping]] = ..., gripper: _Optional[float] = ..., phase: _Optional[_Union[DriverPhase, str]] = ..., fault: _Optional[str] = ..., reason: _Optional[str] = ..., age_s: _Optional[float] = ..., follows_tick: _Optional[int] = ...) -> None: ...

class DriverHello(_message.Message):
    __slots__ = ("arm", "driver", "instance", "kind", "joints", "model_sha256", "wire_version", "servo_hz")
    ARM_FIELD_NUMBER: _ClassVar[int]
    DRIVER_FIELD_NUMBER: _ClassVar[int]
    INSTANCE_FIELD_NUMBER: _ClassVar[int]
    KIND_FIELD_NUMBER: _ClassVar[int]
    JOINTS_FIELD_NUMBER: _ClassVar[int]
    MODEL_SHA256_FIELD_NUMBER: _ClassVar[int]
    WIRE_VERSION_FIELD_NUMBER: _ClassVar[int]
    SERVO_HZ_FIELD_NUMBER: _ClassVar[int]
    arm: str
    driver: str
    instance: str
    kind: str
    joints: int
    model_sha256: str
    wire_version: int
    servo_hz: float
    def __init__(self, arm: _Optional[str] = ..., driver: _Optional[str] = ..., instance: _Optional[str] = ..., kind: _Optional[str] = ..., joints: _Optional[int] = ..., model_sha256: _Optional[str] = ..., wire_version: _Optional[int] = ..., servo_hz: _Optional[float] = ...) -> None: ...

class DriverReply(_message.Message):
    __slots__ = ("error", "session", "boot")
    ERROR_FIELD_NUMBER: _ClassVar[int]
    SESSION_FIELD_NUMBER: _ClassVar[int]
    BOOT_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    session: int
    boot: int
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., session: _Optional[int] = ..., boot: _Optional[int] = ...) -> None: ...
