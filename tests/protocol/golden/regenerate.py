"""Writes the golden bytes anew, when the wire is meant to change: `python -m tests.protocol.golden.regenerate`.

messages.json holds the examples that people wrote; every_message.json each message of the schemas with all its fields.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from google.protobuf.message import Message

from mart.protocol.codec import encode
from tests.protocol.every_message import filled
from tests.protocol.message_examples import examples


def write(name: str, messages: Mapping[str, Message]) -> None:
    golden = {key: encode(message).hex() for key, message in sorted(messages.items())}
    (Path(__file__).parent / name).write_text(json.dumps(golden, indent=1) + "\n")


write("messages.json", examples())
write("every_message.json", filled())
