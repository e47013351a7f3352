"""Writes messages.json anew, when the wire is meant to change: `python -m tests.protocol.golden.regenerate`."""

from __future__ import annotations

import json
from pathlib import Path

from mart.protocol.codec import encode
from tests.protocol.message_examples import examples

golden = {name: encode(message).hex() for name, message in sorted(examples().items())}
(Path(__file__).parent / "messages.json").write_text(json.dumps(golden, indent=1) + "\n")
