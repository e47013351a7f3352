"""Read LeRobot's data sets of version 3: Parquet and JSON; MART's own exports with all that they carry.

Sizes that a file says are looked at first, tables are read in pieces, and no path leads out of the folder.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Corrupt
from mart.recorder.importing import hdf5, parquet
from mart.recorder.importing.file_digest import sha256_of
from mart.recorder.importing.foreign_episode import (
    MAX_ROWS,
    MAX_WIDTH,
    Array,
    ForeignEpisode,
    NotImported,
    Setting,
)
from mart.recorder.importing.lerobot_info import LeRobotInfo, read_info
from mart.recorder.importing.origin_reading import read_origin
from mart.recorder.importing.setting import setting_of_robot

ORIGINS = "meta/mart.hdf5"
_INDEX = ("episode_index", "frame_index")
_FLAGS = ("source", "engaged", "recorded_tick", "next.success", "next.reward")
_SLOT = re.compile(r"(.+)/([0-9]+)")


def read_setting(path: Path) -> Setting:
    """Read of what the data set is. Raises NotFound and Corrupt."""
    info = read_info(path)
    return setting_of_robot(info.instruction, info.features, info.fps)


def read_episodes(path: Path) -> Iterator[ForeignEpisode | NotImported]:
    """Iterate over the episodes in their order, one in memory at a time; one that cannot be used is told of instead.

    Raises NotFound, and Corrupt where nothing of the folder can be used.
    """
    info = read_info(path)
    found: set[int] = set()
    for table in info.data_files:
        try:
            yield from _of_file(table, info, found)
        except Corrupt as error:
            yield NotImported(table.relative_to(path).as_posix(), str(error))
    for number in sorted(info.lengths.keys() - found):
        yield NotImported(f"episode {number}", "its frames are missing; the folder holds half a data set.")


@dataclass(frozen=True)
class _Source:
    """Hold what the episodes of one file have in common."""

    path: Path
    sha256: str
    info: LeRobotInfo
    left_out: tuple[str, ...]


def _of_file(path: Path, info: LeRobotInfo, found: set[int]) -> Iterator[ForeignEpisode | NotImported]:
    wanted, left_out = _columns(info.features)
    source = _Source(path, sha256_of(path), info, tuple(left_out))
    widths = {**dict.fromkeys(_INDEX, 1), **wanted}
    for number, columns in parquet.groups(path, widths, "episode_index", MAX_ROWS):
        name = f"episode {number}"
        if number in found:
            yield NotImported(name, "its frames are in two places.")
            continue
        found.add(number)
        try:
            yield _episode(number, name, columns, source)
        except Corrupt as error:
            yield NotImported(name, str(error))


def _columns(features: Mapping[str, Mapping[str, Any]]) -> tuple[dict[str, int], list[str]]:
    """Return how wide the columns are that are read, and of the others, in sentences, why not."""
    wanted: dict[str, int] = {}
    left_out: list[str] = []
    for name, feature in features.items():
        shape, kind = feature.get("shape"), feature.get("dtype")
        if kind in ("video", "image"):
            left_out.append(f"{name!r} is of pictures; numbers alone are imported.")
            continue
        is_wanted = name in _FLAGS or name == "action" or name.startswith("observation.")
        if not is_wanted:
            continue
        width = int(np.prod(shape, dtype=np.float64)) if isinstance(shape, list) and _are_sizes(shape) else 0
        if not 0 < width <= MAX_WIDTH:
            raise Corrupt(f"{name!r} has the shape {shape}; 1 to {MAX_WIDTH} numbers are taken.")
        wanted[name] = width
    return wanted, left_out


def _are_sizes(shape: list[Any]) -> bool:
    return len(shape) <= 4 and all(isinstance(n, int) and 0 < n <= MAX_WIDTH for n in shape)


def _episode(number: int, name: str, columns: Mapping[str, NDArray[Any]], source: _Source) -> ForeignEpisode:
    count = len(columns["episode_index"])
    if not np.array_equal(columns["frame_index"].ravel(), np.arange(count)):
        raise Corrupt("its frames are not numbered 0, 1, 2, …; some are missing.")
    said = source.info.lengths.get(number)
    if said != count:
        raise Corrupt(f"it has {count} frames, and its metadata says {said}.")
    if "action" not in columns:
        raise Corrupt("it has no actions.")
    success = columns.get("next.success", columns.get("next.reward"))
    ticks = columns.get("recorded_tick")
    return ForeignEpisode(
        name=name,
        number=number,
        source_file=f"{source.info.root.name}/{source.path.relative_to(source.info.root).as_posix()}",
        source_sha256=source.sha256,
        observations=_observations(columns, source.info.features),
        actions=columns["action"].astype(np.float64),
        success=None if success is None else success.ravel() > 0,
        sources=columns["source"].astype(np.int64) if "source" in columns else None,
        engaged=columns["engaged"] > 0 if "engaged" in columns else None,
        ticks=None if ticks is None else ticks.ravel().astype(np.int64),
        instruction=source.info.instructions.get(number, ""),
        left_out=source.left_out,
        origin=_origin(source.info.root, number),
    )


def _observations(
    columns: Mapping[str, NDArray[Any]], features: Mapping[str, Mapping[str, Any]]
) -> dict[str, Array]:
    """Return by key what was seen: columns whose numbers are named `{observation}/{i}` become those observations."""
    found: dict[str, Array] = {}
    for column, values in columns.items():
        if column.startswith("observation."):
            slots = _slots(features[column].get("names"), values.shape[1])
            for key, indices in (slots or {column: list(range(values.shape[1]))}).items():
                found[key] = values[:, indices].astype(np.float64)
    return found


def _slots(names: Any, width: int) -> dict[str, list[int]] | None:
    """Return by observation which numbers of a column are its, None where they are not named as MART names them."""
    if not isinstance(names, list) or len(names) != width:
        return None
    found: dict[str, list[int]] = {}
    for index, name in enumerate(names):
        match = _SLOT.fullmatch(name) if isinstance(name, str) else None
        if match is None or int(match[2]) != len(found.setdefault(match[1].replace("/", "_"), [])):
            return None
        found[match[1].replace("/", "_")].append(index)
    return found


def _origin(root: Path, number: int) -> Any:
    path = root / ORIGINS
    if not path.is_file() or path.is_symlink():
        return None
    with hdf5.opened(path) as file:
        return read_origin(file, f"episode_{number}")
