from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class CameraFrame(_message.Message):
    __slots__ = ("room", "camera", "sequence", "captured_ns", "age_s", "jpeg")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    CAMERA_FIELD_NUMBER: _ClassVar[int]
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    CAPTURED_NS_FIELD_NUMBER: _ClassVar[int]
    AGE_S_FIELD_NUMBER: _ClassVar[int]
    JPEG_FIELD_NUMBER: _ClassVar[int]
    room: str
    camera: str
    sequence: int
    captured_ns: int
    age_s: float
    jpeg: bytes
    def __init__(self, room: _Optional[str] = ..., camera: _Optional[str] = ..., sequence: _Optional[int] = ..., captured_ns: _Optional[int] = ..., age_s: _Optional[float] = ..., jpeg: _Optional[bytes] = ...) -> None: ...

class CameraReport(_message.Message):
    __slots__ = ("room", "camera", "dark", "dark_s", "width_px", "height_px", "frames_per_s")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    CAMERA_FIELD_NUMBER: _ClassVar[int]
    DARK_FIELD_NUMBER: _ClassVar[int]
    DARK_S_FIELD_NUMBER: _ClassVar[int]
    WIDTH_PX_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_PX_FIELD_NUMBER: _ClassVar[int]
    FRAMES_PER_S_FIELD_NUMBER: _ClassVar[int]
    room: str
    camera: str
    dark: str
    dark_s: float
    width_px: int
    height_px: int
    frames_per_s: float
    def __init__(self, room: _Optional[str] = ..., camera: _Optional[str] = ..., dark: _Optional[str] = ..., dark_s: _Optional[float] = ..., width_px: _Optional[int] = ..., height_px: _Optional[int] = ..., frames_per_s: _Optional[float] = ...) -> None: ...
