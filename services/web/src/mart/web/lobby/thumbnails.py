"""The newest small picture of each seat that somebody sits at, for the lobby. Pure; times are monotonic seconds."""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.errors import InvalidInput, NotFound

FRESH_S = 6.0  # a seat makes one every two seconds
MAX_BYTES = 64 * 1024
_MAX_SEATS = 256
_JPEG = b"\xff\xd8\xff"


@dataclass(frozen=True)
class _Thumbnail:
    jpeg: bytes
    number: int
    seen_s: float


class Thumbnails:
    """The newest small picture of each seat, for at most 256 seats."""

    def __init__(self) -> None:
        self._by_seat: dict[tuple[str, str], _Thumbnail] = {}
        self._seen = 0

    def see(self, room: str, camera: str, jpeg: bytes, now_s: float) -> None:
        """Keep the picture of a seat; raises InvalidInput where this is no JPEG, or a large one."""
        if not jpeg.startswith(_JPEG) or len(jpeg) > MAX_BYTES:
            raise InvalidInput(f"{len(jpeg)} bytes were given; a still is a JPEG of at most {MAX_BYTES}.")
        self._seen += 1
        self._by_seat.pop((room, camera), None)
        self._by_seat[room, camera] = _Thumbnail(jpeg, self._seen, now_s)
        if len(self._by_seat) > _MAX_SEATS:
            del self._by_seat[next(iter(self._by_seat))]  # the one that was not renewed for longest

    def number(self, room: str, now_s: float) -> int:
        """Return another number for each picture of a room; 0 where there is none."""
        still = self._shown(room, now_s)
        return still.number if still else 0

    def numbers(self, room: str, now_s: float) -> dict[str, int]:
        """Return another number for each picture of each seat of a room that has one, by its camera."""
        return {camera: still.number for camera, still in sorted(self._fresh(room, now_s).items())}

    def jpeg_of(self, room: str, camera: str, now_s: float) -> bytes:
        """Return the picture of one seat; raises NotFound where nobody has looked from there in the last seconds."""
        still = self._fresh(room, now_s).get(camera)
        if still is None:
            raise NotFound(f"Nobody looks from {camera} in {room} now, so there is no picture.")
        return still.jpeg

    def jpeg(self, room: str, now_s: float) -> bytes:
        """Return the picture of a room; raises NotFound where nobody has looked at it in the last seconds."""
        still = self._shown(room, now_s)
        if still is None:
            raise NotFound(f"Nobody looks at {room} now, so there is no picture; take or watch a seat there.")
        return still.jpeg

    def _shown(self, room: str, now_s: float) -> _Thumbnail | None:
        """The first seat's, so that the picture does not change sides."""
        fresh = self._fresh(room, now_s)
        return fresh[min(fresh)] if fresh else None

    def _fresh(self, room: str, now_s: float) -> dict[str, _Thumbnail]:
        return {
            camera: still
            for (where, camera), still in self._by_seat.items()
            if where == room and now_s - still.seen_s <= FRESH_S
        }
