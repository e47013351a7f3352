"""Read scenes and pose messages back, as pages do: docs/protocol.md, "Scene" and "Body poses"."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ReadScene:
    description: dict[str, Any]
    buffer: bytes

    def mesh(self, index: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
        """Positions (n, 3), normals (n, 3) and triangles (m, 3) of a mesh."""
        entry = self.description["meshes"][index]
        count, at = entry["vertices"], entry["offset"]
        packed = np.frombuffer(self.buffer, "<u2", 3 * count, at).reshape(-1, 3)
        at += -(-6 * count // 4) * 4
        normals = np.frombuffer(self.buffer, "<i1", 3 * count, at).reshape(-1, 3) / 127
        at += -(-3 * count // 4) * 4
        triangles = np.frombuffer(
            self.buffer, "<u4" if entry["wide_indices"] else "<u2", entry["indices"], at
        )
        positions = np.array(entry["origin_m"]) + packed * np.array(entry["step_m"])
        return positions, normals, triangles.reshape(-1, 3).astype(np.int64)

    def texture(self, index: int) -> NDArray[np.uint8]:
        """The pixels of a texture."""
        entry = self.description["textures"][index]
        shape = entry["height"], entry["width"], entry["channels"]
        differences = np.frombuffer(self.buffer, np.uint8, int(np.prod(shape)), entry["offset"])
        return np.cumsum(differences.reshape(shape), axis=1, dtype=np.uint8)


@dataclass(frozen=True)
class ReadPoses:
    scene: str
    tick: int
    positions_m: NDArray[np.float64]
    quaternions: NDArray[np.float64]


def read_scene(data: bytes) -> ReadScene:
    """The scene in these bytes."""
    magic, length = struct.unpack_from("<4sI", data)
    assert magic == b"MSC1"
    return ReadScene(json.loads(data[8 : 8 + length]), data[8 + length :])


def read_poses(message: bytes) -> ReadPoses:
    """The poses in a message."""
    magic, scene, tick, step_m, count, zero = struct.unpack_from("<4s4sQfHH", message)
    assert (magic, zero, len(message)) == (b"MBP1", 0, 24 + 14 * count)
    numbers = np.frombuffer(message, "<i2", 7 * count, 24).reshape(-1, 7).astype(np.float64)
    return ReadPoses(scene.hex(), tick, numbers[:, :3] * step_m, numbers[:, 3:] / 32_767)
