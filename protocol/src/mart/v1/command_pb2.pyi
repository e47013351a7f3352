from mart.v1 import pose_pb2 as _pose_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Operator(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    OPERATOR_UNSPECIFIED: _ClassVar[Operator]
    OPERATOR_HOLD: _ClassVar[Operator]
    OPERATOR_HUMAN: _ClassVar[Operator]
    OPERATOR_POLICY: _ClassVar[Operator]
    OPERATOR_SCRIPT: _ClassVar[Operator]
    OPERATOR_GENERATED: _ClassVar[Operator]

class HandFault(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    HAND_FAULT_UNSPECIFIED: _ClassVar[HandFault]
    HAND_FAULT_TRACKING: _ClassVar[HandFault]
    HAND_FAULT_JUMP: _ClassVar[HandFault]
OPERATOR_UNSPECIFIED: Operator
OPERATOR_HOLD: Operator
OPERATOR_HUMAN: Operator
OPERATOR_POLICY: Operator
OPERATOR_SCRIPT: Operator
OPERATOR_GENERATED: Operator
HAND_FAULT_UNSPECIFIED: HandFault
HAND_FAULT_TRACKING: HandFault
HAND_FAULT_JUMP: HandFault

class CommandStamps(_message.Message):
    __slots__ = ("input_sent_ns", "gateway_received_ns", "sent_ns")
    INPUT_SENT_NS_FIELD_NUMBER: _ClassVar[int]
    GATEWAY_RECEIVED_NS_FIELD_NUMBER: _ClassVar[int]
    SENT_NS_FIELD_NUMBER: _ClassVar[int]
    input_sent_ns: int
    gateway_received_ns: int
    sent_ns: int
    def __init__(self, input_sent_ns: _Optional[int] = ..., gateway_received_ns: _Optional[int] = ..., sent_ns: _Optional[int] = ...) -> None: ...

class Command(_message.Message):
    __slots__ = ("arm", "seat_epoch", "sequence", "target_tool_in_base", "gripper", "engaged", "source", "stamps", "seen_tick", "emergency_stop", "state_tick", "hand_fault")
    ARM_FIELD_NUMBER: _ClassVar[int]
    SEAT_EPOCH_FIELD_NUMBER: _ClassVar[int]
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    TARGET_TOOL_IN_BASE_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_FIELD_NUMBER: _ClassVar[int]
    ENGAGED_FIELD_NUMBER: _ClassVar[int]
    SOURCE_FIELD_NUMBER: _ClassVar[int]
    STAMPS_FIELD_NUMBER: _ClassVar[int]
    SEEN_TICK_FIELD_NUMBER: _ClassVar[int]
    EMERGENCY_STOP_FIELD_NUMBER: _ClassVar[int]
    STATE_TICK_FIELD_NUMBER: _ClassVar[int]
    HAND_FAULT_FIELD_NUMBER: _ClassVar[int]
    arm: str
    seat_epoch: int
    sequence: int
    target_tool_in_base: _pose_pb2.Pose
    gripper: float
    engaged: bool
    source: Operator
    stamps: CommandStamps
    seen_tick: int
    emergency_stop: bool
    state_tick: int
    hand_fault: HandFault
    def __init__(self, arm: _Optional[str] = ..., seat_epoch: _Optional[int] = ..., sequence: _Optional[int] = ..., target_tool_in_base: _Optional[_Union[_pose_pb2.Pose, _Mapping]] = ..., gripper: _Optional[float] = ..., engaged: _Optional[bool] = ..., source: _Optional[_Union[Operator, str]] = ..., stamps: _Optional[_Union[CommandStamps, _Mapping]] = ..., seen_tick: _Optional[int] = ..., emergency_stop: _Optional[bool] = ..., state_tick: _Optional[int] = ..., hand_fault: _Optional[_Union[HandFault, str]] = ...) -> None: ...
