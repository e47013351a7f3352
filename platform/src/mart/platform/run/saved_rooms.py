"""The rooms that people have opened, kept over a restart: the requests that opened them, one a line."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from google.protobuf.json_format import MessageToJson, Parse, ParseError

from mart.protocol.errors import Corrupt
from mart.protocol.messages import RoomsRequest
from mart.runtime.atomic_file import write_atomically


def load(path: Path) -> list[RoomsRequest.Open]:
    """Empty where nothing was kept. Raises Corrupt, with the file put aside, where it is no such list."""
    if not path.exists():
        return []
    try:
        return [Parse(line, RoomsRequest.Open()) for line in path.read_text().splitlines()]
    except (ParseError, UnicodeDecodeError) as error:
        damaged = path.replace(path.with_suffix(".damaged"))
        raise Corrupt(
            f"{path} is no list of rooms, so what was opened from the lobby does not come back; it is {damaged} now: "
            f"mend it and give it its name again, or open the rooms anew ({error})."
        ) from error


def save(path: Path, rooms: Iterable[RoomsRequest.Open]) -> None:
    lines = (MessageToJson(room, indent=None, preserving_proto_field_name=True) for room in rooms)
    write_atomically(path, "".join(f"{line}\n" for line in lines).encode())
