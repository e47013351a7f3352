"""Keep of every camera what is needed to decode what comes next: the newest key frame and what followed it. Pure."""

from __future__ import annotations

from dataclasses import dataclass, field

from mart.episodes.mcap_entries import McapEntry

_MAX_GROUP_BYTES = 8 * 1024 * 1024  # of video between two key frames
_MAX_CAMERAS = 16


@dataclass
class _PictureGroup:
    """Keep the newest key frame of one camera and what follows it."""

    entries: list[McapEntry] = field(default_factory=list)
    size: int = 0

    def add(self, entry: McapEntry, is_key: bool) -> None:
        if is_key or self.size > _MAX_GROUP_BYTES:
            self.entries, self.size = [], 0
        if is_key or self.entries:
            self.entries.append(entry)
            self.size += len(entry.payload)


class NewestPictures:
    """Keep the pictures of a room's cameras since the last key frame of each."""

    def __init__(self) -> None:
        self._groups: dict[str, _PictureGroup] = {}

    def add(self, camera: str, entry: McapEntry, is_key: bool) -> None:
        """Keep a picture; of more than 16 cameras the later ones are left out."""
        if camera in self._groups or len(self._groups) < _MAX_CAMERAS:
            self._groups.setdefault(camera, _PictureGroup()).add(entry, is_key)

    def since(self, since_ns: int) -> list[McapEntry]:
        """Return what is kept and arrived since then (Unix time)."""
        kept = (entry for group in self._groups.values() for entry in group.entries)
        return [entry for entry in kept if entry.arrived_ns >= since_ns]


def has_key_frame(annex_b: bytes) -> bool:
    """Tell whether H.264 in Annex B form (ITU-T H.264, table 7-1) holds a sequence parameter set or an IDR slice."""
    at = annex_b.find(b"\x00\x00\x01")
    while 0 <= at < len(annex_b) - 3:
        if annex_b[at + 3] & 0x1F in (5, 7):
            return True
        at = annex_b.find(b"\x00\x00\x01", at + 3)
    return False
