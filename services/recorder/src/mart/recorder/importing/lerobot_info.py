"""Read what a LeRobot folder says of itself: `meta/info.json`, its episodes and its tasks."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mart.protocol.errors import Corrupt, NotFound
from mart.recorder.importing import parquet
from mart.recorder.importing.foreign_episode import MAX_EPISODES

VERSION = "v3.0"
_MAX_INFO_BYTES = 4 * 1024 * 1024
_MAX_FILES = 10_000
_MAX_FEATURES = 1000
_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


@dataclass(frozen=True)
class LeRobotInfo:
    """Hold what a folder says. lengths, instructions: by the number of an episode, its frames and its task in words."""

    root: Path
    fps: float
    features: Mapping[str, Mapping[str, Any]]
    lengths: Mapping[int, int]
    instructions: Mapping[int, str]
    data_files: tuple[Path, ...]

    @property
    def instruction(self) -> str:
        """The one task in words that all episodes have; empty where they have several."""
        said = set(self.instructions.values())
        return said.pop() if len(said) == 1 else ""


def read_info(root: Path) -> LeRobotInfo:
    """Read it. Raises NotFound where there is no such folder, Corrupt where it is none of LeRobot's, or but half."""
    info = _json(root / "meta/info.json", root)
    version = info.get("codebase_version")
    if version != VERSION:
        raise Corrupt(
            f"{root} is a data set of version {version!r}; {VERSION} is read. LeRobot converts older ones: "
            "`python -m lerobot.datasets.v30.convert_dataset_v21_to_v30`."
        )
    features, fps = info.get("features"), info.get("fps")
    if not isinstance(features, dict) or not _are_features(features):
        raise Corrupt(f"{root}/meta/info.json does not say what its columns are (`features`).")
    if isinstance(fps, bool) or not isinstance(fps, int | float) or not math.isfinite(fps) or fps <= 0:
        raise Corrupt(f"{root}/meta/info.json does not say how many frames a second has (`fps`).")
    if info.get("data_path", _DATA) != _DATA:
        raise Corrupt(
            f"{root}/meta/info.json says that its data are at {str(info['data_path'])[:80]!r}; version 3 has them at "
            f"{_DATA!r}, and no other path is followed."
        )
    lengths, instructions = _episodes(root)
    return LeRobotInfo(root, float(fps), features, lengths, instructions, _files(root, "data"))


def _are_features(features: dict[str, Any]) -> bool:
    return 0 < len(features) <= _MAX_FEATURES and all(isinstance(one, dict) for one in features.values())


def _json(path: Path, root: Path) -> dict[str, Any]:
    if not path.is_file():
        raise NotFound(f"There is no {path}; name the folder of a data set of LeRobot's, version 3.")
    _require_inside(path, root)
    if path.stat().st_size > _MAX_INFO_BYTES:
        raise Corrupt(
            f"{path} has more than {_MAX_INFO_BYTES >> 20} MiB; it is no description of a data set."
        )
    try:
        said = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise Corrupt(f"{path} is no JSON: {error}.") from error
    if not isinstance(said, dict):
        raise Corrupt(f"{path} is no JSON object.")
    return said


def _episodes(root: Path) -> tuple[dict[int, int], dict[int, str]]:
    """Return by episode how many frames it has, and its first task in words."""
    lengths: dict[int, int] = {}
    instructions: dict[int, str] = {}
    files = _files(root, "meta/episodes")
    if not files:
        raise Corrupt(f"{root} has no meta/episodes; it is half a data set.")
    for path in files:
        for row in parquet.records(path, ("episode_index", "length", "tasks"), MAX_EPISODES):
            number, length, tasks = row.get("episode_index"), row.get("length"), row.get("tasks")
            if not isinstance(number, int) or not isinstance(length, int) or not 0 <= number < 2**31:
                raise Corrupt(f"{path} does not say which episodes there are.")
            lengths[number] = length
            if isinstance(tasks, list) and tasks and isinstance(tasks[0], str):
                instructions[number] = tasks[0]
    return lengths, instructions


def _files(root: Path, below: str) -> tuple[Path, ...]:
    """Return the tables below a folder, in order. Raises Corrupt where one leads out of the data set."""
    found = sorted((root / below).glob("chunk-*/file-*.parquet"))
    if len(found) > _MAX_FILES:
        raise Corrupt(f"{root / below} holds {len(found)} tables; at most {_MAX_FILES} are taken.")
    for path in found:
        _require_inside(path, root)
    return tuple(found)


def _require_inside(path: Path, root: Path) -> None:
    if not path.resolve().is_relative_to(root.resolve()):
        raise Corrupt(f"{path} is a link that leads out of {root}; it is not followed, copy the file.")
