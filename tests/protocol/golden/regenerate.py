"""Writes messages.json anew. Run it only when the wire is meant to change: `python tests/protocol/golden/regenerate.py`."""

from __future__ import annotations

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from message_examples import examples

from mart.protocol.codec import encode

golden = {name: encode(message).hex() for name, message in sorted(examples().items())}
(Path(__file__).parent / "messages.json").write_text(json.dumps(golden, indent=1) + "\n")
