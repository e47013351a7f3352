from mart.v1 import room_pb2 as _room_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Offer(_message.Message):
    __slots__ = ("token", "sdp")
    TOKEN_FIELD_NUMBER: _ClassVar[int]
    SDP_FIELD_NUMBER: _ClassVar[int]
    token: str
    sdp: str
    def __init__(self, token: _Optional[str] = ..., sdp: _Optional[str] = ...) -> None: ...

class Answer(_message.Message):
    __slots__ = ("error", "sdp")
    ERROR_FIELD_NUMBER: _ClassVar[int]
    SDP_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    sdp: str
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., sdp: _Optional[str] = ...) -> None: ...

class OpenSeat(_message.Message):
    __slots__ = ("room", "arm", "seat_epoch")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    ARM_FIELD_NUMBER: _ClassVar[int]
    SEAT_EPOCH_FIELD_NUMBER: _ClassVar[int]
    room: str
    arm: str
    seat_epoch: int
    def __init__(self, room: _Optional[str] = ..., arm: _Optional[str] = ..., seat_epoch: _Optional[int] = ...) -> None: ...

class OpenSeatReply(_message.Message):
    __slots__ = ("error",)
    ERROR_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ...) -> None: ...

class SceneRequest(_message.Message):
    __slots__ = ("known_sha256",)
    KNOWN_SHA256_FIELD_NUMBER: _ClassVar[int]
    known_sha256: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, known_sha256: _Optional[_Iterable[str]] = ...) -> None: ...

class SceneReply(_message.Message):
    __slots__ = ("error", "sha256", "scene_gzip")
    ERROR_FIELD_NUMBER: _ClassVar[int]
    SHA256_FIELD_NUMBER: _ClassVar[int]
    SCENE_GZIP_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    sha256: str
    scene_gzip: bytes
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., sha256: _Optional[str] = ..., scene_gzip: _Optional[bytes] = ...) -> None: ...
