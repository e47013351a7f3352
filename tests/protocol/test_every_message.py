"""No message and no field of the wire changes by accident, and none is forgotten."""

from __future__ import annotations

import json
from pathlib import Path

from mart.protocol.codec import decode, encode
from tests.protocol.every_message import filled, kinds

GOLDEN: dict[str, str] = json.loads((Path(__file__).parent / "golden" / "every_message.json").read_text())
ANEW = "where the wire is meant to change, run: python -m tests.protocol.golden.regenerate"


def test_every_message_of_the_schemas_has_golden_bytes() -> None:
    assert sorted(GOLDEN) == sorted(filled()), ANEW
    assert {name.partition("=")[0].rpartition(".")[0] if "=" in name else name for name in GOLDEN} == set(
        kinds()
    )


def test_every_field_is_written_as_it_was() -> None:
    changed = [name for name, message in filled().items() if encode(message).hex() != GOLDEN.get(name)]
    assert not changed, ANEW


def test_golden_bytes_are_read_again() -> None:
    for name, message in filled().items():
        assert decode(type(message), bytes.fromhex(GOLDEN[name])) == message, name
