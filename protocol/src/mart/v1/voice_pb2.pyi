from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class VoicePacket(_message.Message):
    __slots__ = ("room", "speaker_id", "name", "arm", "timestamp", "sent_ns", "opus")
    ROOM_FIELD_NUMBER: _ClassVar[int]
    SPEAKER_ID_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    ARM_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_FIELD_NUMBER: _ClassVar[int]
    SENT_NS_FIELD_NUMBER: _ClassVar[int]
    OPUS_FIELD_NUMBER: _ClassVar[int]
    room: str
    speaker_id: str
    name: str
    arm: str
    timestamp: int
    sent_ns: int
    opus: bytes
    def __init__(self, room: _Optional[str] = ..., speaker_id: _Optional[str] = ..., name: _Optional[str] = ..., arm: _Optional[str] = ..., timestamp: _Optional[int] = ..., sent_ns: _Optional[int] = ..., opus: _Optional[bytes] = ...) -> None: ...
