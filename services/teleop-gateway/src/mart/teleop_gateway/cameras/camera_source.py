"""Say what a camera is captured from. Addresses may hold passwords: none is in a repr, a log or an error."""

from __future__ import annotations

import enum
import stat
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

from mart.protocol.errors import InvalidInput

_SCHEMES = ("rtsp", "rtsps", "http", "https", "udp", "tcp")
_MAX_CHARACTERS = 2048
_OTHERS = stat.S_IRWXG | stat.S_IRWXO


class CameraKind(enum.Enum):
    """Name how a camera is reached."""

    DEVICE = "device"
    STREAM = "stream"
    FILE = "file"


@dataclass(frozen=True)
class CameraSource:
    """Hold what OpenCV opens, and how people may be told of it."""

    kind: CameraKind
    address: str = field(repr=False)
    title: str

    @property
    def device(self) -> int | str:
        """Return what V4L2 opens: a number, or the path of a device."""
        return int(self.address) if self.address.isdigit() else self.address


def load_source(text: str) -> CameraSource:
    """Return the source that a text names: /dev/video0 or 0, a URL, a video's path, or @FILE that holds one of these.

    Raises InvalidInput where it names nothing that can be a camera, or where others may read the @FILE.
    """
    if text.startswith("@"):
        text = _read_private(Path(text[1:]))
    text = text.strip()
    if not text or len(text) > _MAX_CHARACTERS or not text.isprintable():
        raise InvalidInput(
            "A camera was given without a source: write NAME=/dev/video0, NAME=rtsp://…, a video file, or NAME=@FILE."
        )
    if "://" in text:
        return _stream(text)
    if text.isdigit() or text.startswith("/dev/"):
        return CameraSource(CameraKind.DEVICE, text, f"/dev/video{text}" if text.isdigit() else text)
    if not Path(text).is_file():
        raise InvalidInput(
            f"The camera's source {Path(text).name!r} is no device, no URL and no file that is there."
        )
    return CameraSource(CameraKind.FILE, str(Path(text).resolve()), Path(text).name)


def _stream(text: str) -> CameraSource:
    try:
        parts = urlsplit(text)
        scheme, host = parts.scheme.lower(), parts.hostname or ""
    except ValueError:
        scheme, host = "", ""
    if scheme not in _SCHEMES or not host:
        raise InvalidInput(
            f"A camera's URL was given that cannot be one; it begins with {', '.join(_SCHEMES)} and names a host."
        )
    return CameraSource(CameraKind.STREAM, text, f"{scheme}://{host}/…")


def _read_private(path: Path) -> str:
    try:
        if path.stat().st_mode & _OTHERS:
            raise InvalidInput(f"{path} can be read by others; make it private: chmod 600 {path}.")
        with path.open(errors="replace") as file:
            return file.read(_MAX_CHARACTERS + 1)
    except OSError as error:
        raise InvalidInput(f"The camera's source in {path} cannot be read: {error.strerror}.") from error
