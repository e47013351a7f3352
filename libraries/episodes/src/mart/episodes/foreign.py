"""Say what a file is that is no episode of MART, and what to do about it, from its first bytes."""

from __future__ import annotations

from mcap.opcode import Opcode
from mcap.records import Header

from mart.episodes.scan import MAGIC, SYMPTOMS, BoundedFile, parse, walk
from mart.protocol.recording import PROFILE

_SHOWN_BYTES = 8
_MOVE = "move it out of the folder"
_KINDS: tuple[tuple[bytes, str, str], ...] = (
    (
        b"version https://git-lfs",
        "a Git LFS pointer, not the file itself",
        "run `git lfs pull` where it lies",
    ),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file", f"{_MOVE}; `mart episodes import` makes episodes of it"),
    (b"PAR1", "a Parquet file", f"{_MOVE}; `mart episodes import` makes episodes of LeRobot's folders"),
    (b"#ROSBAG V", "a bag of ROS 1", _MOVE),
    (b"SQLite format 3\0", "an SQLite database, as bags of ROS 2 may be", _MOVE),
    (b"\x1f\x8b", "packed with gzip", "unpack it first"),
    (b"\x28\xb5\x2f\xfd", "packed with zstd", "unpack it first"),
    (b"PK\x03\x04", "a ZIP archive", "unpack it first"),
)
_LONGEST = max(len(start) for start, _, _ in _KINDS)


def foreign_kind(file: BoundedFile) -> str:
    """Say what a file is, as a clause with what to do, where it is no MCAP file of MART's; empty for one that is.

    A file that is cut off within its head, or whose head is damaged, counts as MART's: a crash may have left it.
    """
    if file.size == 0:
        return "is empty: nothing was ever written into it, or copying it failed; delete it or copy it again"
    start = file.piece(0, min(_LONGEST, file.size))
    for first, what, advice in _KINDS:
        if start.startswith(first):
            return f"is {what}; {advice}"
    if start[: len(MAGIC)] != MAGIC[: len(start)]:
        shown = start[:_SHOWN_BYTES].hex(" ")
        return f"is no MCAP file (it begins with {shown}); {_MOVE}, or copy it again"
    profile = _profile(file)
    if profile in (None, PROFILE):
        return ""
    return (
        f"is an MCAP file of another kind or version: its profile is {profile[:64]!r}, and this version of MART "
        f"reads {PROFILE!r}; {_MOVE}"
    )


def _profile(file: BoundedFile) -> str | None:
    """Return what the head of an MCAP file says; None where it cannot be read."""
    try:
        first = next(walk(file))
        head = parse(file, first) if first.opcode == Opcode.HEADER else None
    except SYMPTOMS:
        return None
    return head.profile if isinstance(head, Header) else None
