"""Pack meshes and textures for a page that draws: docs/protocol.md, "Scene". Pure."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mart.render.unit_shapes import Corners

MAGIC = b"MSC1"
_ALIGNED = 4
_STEPS = 65_535  # of a position along each side of a mesh's box
_NORMAL = 127
_LARGEST_SHORT_INDEX = 65_536


@dataclass(frozen=True)
class MeshEntry:
    """Say where a mesh lies in the buffer, and how its positions are read: `origin_m` + `step_m` * number."""

    offset: int
    vertices: int
    indices: int
    wide_indices: bool
    origin_m: list[float]
    step_m: list[float]

    def as_json(self) -> dict[str, Any]:
        """Return the entry as the scene's description holds it."""
        return dict(vars(self))


class SceneBuffer:
    """Collect the bytes that a scene's description points into."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0

    def add(self, data: bytes) -> int:
        """Append bytes and return where they begin; what follows begins at a multiple of 4."""
        offset = self._size
        padded = data + bytes(-len(data) % _ALIGNED)
        self._parts.append(padded)
        self._size += len(padded)
        return offset

    def add_mesh(self, corners: Corners) -> MeshEntry:
        """Append a mesh: uint16 positions, int8 normals, then indices; corners that are the same become one."""
        low = corners.positions.min(axis=0)
        step = np.maximum(np.ptp(corners.positions, axis=0), 1e-9) / _STEPS
        rows = np.concatenate(
            (np.rint((corners.positions - low) / step), np.rint(corners.normals * _NORMAL)), axis=1
        ).astype(np.int32)
        kept, indices = np.unique(rows, axis=0, return_inverse=True)
        wide = len(kept) > _LARGEST_SHORT_INDEX
        offset = self.add(kept[:, :3].astype("<u2").tobytes())
        self.add(kept[:, 3:].astype("<i1").tobytes())
        self.add(indices.reshape(-1).astype("<u4" if wide else "<u2").tobytes())
        return MeshEntry(offset, len(kept), len(rows), wide, _rounded(low), _rounded(step))

    def add_texture(self, pixels: NDArray[np.uint8]) -> dict[str, Any]:
        """Append a picture, uint8, shape (height, width, 3 or 4), as differences along its rows; return its entry.

        Differences are half as long once they are compressed.
        """
        height, width, channels = pixels.shape
        differences = np.diff(pixels, axis=1, prepend=np.zeros((height, 1, channels), np.uint8))
        return {
            "offset": self.add(differences.tobytes()),
            "width": width,
            "height": height,
            "channels": channels,
        }

    def joined(self, description: Mapping[str, Any]) -> bytes:
        """Return the scene: magic, length of the description, description (JSON), buffer."""
        text = json.dumps(description, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % _ALIGNED)
        return b"".join((MAGIC, len(text).to_bytes(4, "little"), text, *self._parts))


def _rounded(values: NDArray[np.float64]) -> list[float]:
    return [float(np.float32(value)) for value in values]
