"""Write the Parquet files of LeRobot's data sets: frames, episodes with their statistics, and tasks."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from mart.recorder.export.columns import Columns, arrow_column
from mart.recorder.export.statistics import Statistics, of_numbers, of_pictures
from mart.recorder.export.videos import Histogram

_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
DATA_FILE = f"data/{_FILE}.parquet"
VIDEO_FILE = f"videos/{{video_key}}/{_FILE}.mp4"
_EPISODES_FILE = f"meta/episodes/{_FILE}.parquet"
CHUNK_SIZE, DATA_MB, VIDEO_MB = 1000, 100, 200  # LeRobot's own: files a folder, and how large they get


@dataclass(frozen=True)
class SegmentPart:
    """Hold what of a data set is one episode there. counts, videos: by feature, of each camera.

    origin: what `write_origin` wrote of it.
    """

    columns: Columns
    counts: Mapping[str, Histogram]
    videos: Mapping[str, Path]
    origin: Path

    def __len__(self) -> int:
        return len(self.columns["index"])


def place(number: int) -> tuple[int, int]:
    """Return chunk and file of the file of this number."""
    return divmod(number, CHUNK_SIZE)


def write_data(folder: Path, parts: Sequence[SegmentPart]) -> None:
    """Write the frames, a row group an episode, and the next file where one would pass the limit."""
    for number, row in enumerate(data_files(parts)):
        chunk, file = place(number)
        path = folder / DATA_FILE.format(chunk_index=chunk, file_index=file)
        path.parent.mkdir(parents=True, exist_ok=True)
        tables = [_table(parts[episode]) for episode in row]
        with pq.ParquetWriter(path, tables[0].schema) as writer:
            for table in tables:
                writer.write_table(table)


def data_files(parts: Sequence[SegmentPart], limit_bytes: int = DATA_MB * 1024 * 1024) -> list[list[int]]:
    """Return for each file which episodes are in it."""
    files: list[list[int]] = []
    size = limit_bytes
    for number, part in enumerate(parts):
        own = sum(values.nbytes for values in part.columns.values())  # before compression
        if size + own > limit_bytes:
            files.append([])
            size = 0
        files[-1].append(number)
        size += own
    return files


def write_episodes(folder: Path, parts: Sequence[SegmentPart], instruction: str, control_hz: float) -> None:
    """Write a row for each episode, with its own statistics: LeRobot's tools make those of a data set from them."""
    ends = np.cumsum([*map(len, parts)])
    places = [place(number) for number, row in enumerate(data_files(parts)) for _ in row]
    zeros = [0] * len(parts)
    table: dict[str, Any] = {
        "episode_index": list(range(len(parts))),
        "tasks": [[instruction]] * len(parts),
        "length": [*map(len, parts)],
        "data/chunk_index": [chunk for chunk, _ in places],
        "data/file_index": [file for _, file in places],
        "dataset_from_index": [end - len(part) for part, end in zip(parts, ends.tolist(), strict=True)],
        "dataset_to_index": ends.tolist(),
        **_videos(parts, control_hz),
        **_statistics(parts),
        "meta/episodes/chunk_index": zeros,
        "meta/episodes/file_index": zeros,
    }
    path = folder / _EPISODES_FILE.format(chunk_index=0, file_index=0)
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.table(table), path)


def write_tasks(path: Path, instruction: str) -> None:
    """Write the table as pandas does one whose index is the task in words, which is how LeRobot finds a task."""
    index = "__index_level_0__"
    table = pa.table({"task_index": [0], index: [instruction]})
    kinds = {"task_index": ("int64", "int64"), index: ("unicode", "object")}
    columns = [
        {
            "name": None if name == index else name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": numpy,
        }
        | {"metadata": None}
        for name, (kind, numpy) in kinds.items()
    ]
    said = {"index_columns": [index], "column_indexes": [], "columns": columns}
    pq.write_table(table.replace_schema_metadata({"pandas": json.dumps(said)}), path)


def _table(part: SegmentPart) -> pa.Table:
    return pa.table({name: arrow_column(values) for name, values in part.columns.items()})


def _videos(parts: Sequence[SegmentPart], control_hz: float) -> dict[str, list[Any]]:
    """Say of each video, which is one episode's, where it lies and from when to when the episode is in it."""
    found: dict[str, list[Any]] = {}
    for feature in parts[0].videos:
        chunks, files = zip(*map(place, range(len(parts))), strict=True)
        found[f"videos/{feature}/chunk_index"] = [*chunks]
        found[f"videos/{feature}/file_index"] = [*files]
        found[f"videos/{feature}/from_timestamp"] = [0.0] * len(parts)
        found[f"videos/{feature}/to_timestamp"] = [len(part) / control_hz for part in parts]
    return found


def _statistics(parts: Sequence[SegmentPart]) -> dict[str, pa.Array]:
    """Return by `stats/{feature}/{statistic}` a list for each episode, for the index columns too."""
    found: dict[str, pa.Array] = {}
    for feature in parts[0].columns:
        each = [of_numbers(part.columns[feature]) for part in parts]
        found |= _listed(feature, each, pa.list_(pa.float64()))
    for feature in parts[0].counts:
        each = [of_pictures(part.counts[feature], len(part)) for part in parts]
        found |= _listed(feature, each, pa.list_(pa.list_(pa.list_(pa.float64()))))
    return found


def _listed(feature: str, each: Sequence[Statistics], kind: pa.DataType) -> dict[str, pa.Array]:
    return {
        f"stats/{feature}/{name}": pa.array(
            [one[name] for one in each], type=pa.list_(pa.int64()) if name == "count" else kind
        )
        for name in each[0]
    }
