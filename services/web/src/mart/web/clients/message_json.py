"""Messages of other services as JSON for the pages."""

from __future__ import annotations

from typing import Any, cast

from google.protobuf.json_format import MessageToDict
from google.protobuf.message import Message

from mart.protocol.messages import JobState, job_state_word
from mart.web.lobby.room_json import Json


def as_json(message: Message) -> Json:
    """Return every field under its own name; 64-bit numbers as text, states of jobs in one word."""
    fields = MessageToDict(
        message, preserving_proto_field_name=True, always_print_fields_with_no_presence=True
    )
    return _in_words(fields)


def _in_words(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _in_words(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_in_words(one) for one in value]
    if isinstance(value, str) and value in JobState.keys():
        return job_state_word(cast("JobState", JobState.Value(value)))
    return value
