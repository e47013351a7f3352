"""The scenes that pages draw, asked of seats and kept by their digests. Bounded: the oldest give way."""

from __future__ import annotations

import hashlib
import zlib
from collections import OrderedDict
from collections.abc import Iterable

from mart.protocol.errors import Corrupt, NotFound

MAX_SCENES = 8
MAX_STORED_BYTES = 64 * 1024 * 1024  # of all, compressed; a detailed one has 1.5 MB
MAX_SCENE_BYTES = 64 * 1024 * 1024  # of one, unpacked
_GZIP_WINDOW = 31  # zlib's word for a gzip header


class SceneStore:
    """Scenes by their SHA-256, compressed with gzip as browsers take them."""

    def __init__(self) -> None:
        self._scenes: OrderedDict[str, bytes] = OrderedDict()

    def known(self) -> Iterable[str]:
        """Return the digests of all that are here."""
        return tuple(self._scenes)

    def put(self, sha256: str, scene_gzip: bytes) -> None:
        """Keep a scene; raises Corrupt where it is not what its digest says."""
        unpacking = zlib.decompressobj(_GZIP_WINDOW)
        try:
            scene = unpacking.decompress(scene_gzip, MAX_SCENE_BYTES)
        except zlib.error as error:
            raise Corrupt(f"A scene cannot be unpacked: {error}.") from error
        if not unpacking.eof or hashlib.sha256(scene).hexdigest() != sha256:
            raise Corrupt(
                f"A scene of {len(scene_gzip)} bytes does not match its SHA-256: it was changed on its way."
            )
        self._scenes[sha256] = scene_gzip
        while len(self._scenes) > MAX_SCENES or sum(map(len, self._scenes.values())) > MAX_STORED_BYTES:
            self._scenes.popitem(last=False)

    def get(self, sha256: str) -> bytes:
        """Return a scene, compressed; raises NotFound."""
        if sha256 not in self._scenes:
            raise NotFound(
                f"There is no scene {sha256[:16]!r} here (any more); ask for the scene of a seat again."
            )
        self._scenes.move_to_end(sha256)
        return self._scenes[sha256]
