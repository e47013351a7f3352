"""Write LeRobot's data sets of version 3: a folder of Parquet and JSON.

The format is that of huggingface.co/docs/lerobot/lerobot-dataset-v3.

Numbers only: what was recorded as video is drawn anew by `mart episodes render`. The arms' own observations are
`observation.state`, all others `observation.environment_state`, in the catalogue's order; quaternions stay wxyz.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Conflict
from mart.protocol.tasks import Observation, Task
from mart.recorder.export.origins import GROUP, write_origin
from mart.recorder.export.selection import ExportSelection, read_segments

_VERSION = "v3.0"
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_FIRST = _FILE.format(chunk_index=0, file_index=0)  # numbers alone fit one file
# LeRobot's own, for whoever adds to the data set.
_LIMITS = {"chunks_size": 1000, "data_files_size_in_mb": 100, "video_files_size_in_mb": 200}

Columns = dict[str, NDArray[Any]]  # by feature, one row a frame


def write_lerobot(selection: ExportSelection, path: Path) -> int:
    """Write the folder and return how many frames are in it; it has its name when it is whole.

    Raises Conflict where it is there already or cannot be written, and what `read_segments` raises.
    """
    if path.exists():
        raise Conflict(f"{path} is there already; name another folder or remove it.")
    half = path.with_name(path.name + ".half")
    try:
        frames = _write(selection, half)
        os.replace(half, path)
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error}.") from error
    finally:
        shutil.rmtree(half, ignore_errors=True)
    return frames


def _write(selection: ExportSelection, folder: Path) -> int:
    (folder / "meta").mkdir(parents=True)
    episodes: list[Columns] = []
    with h5py.File(folder / "meta/mart.hdf5", "w") as file:
        origins = file.create_group(GROUP)
        for episode in selection.each(selection.episodes):
            for segment in read_segments(selection, episode):
                write_origin(origins, f"episode_{len(episodes)}", segment, episode, states=False)
                episodes.append(_frames(segment, selection, len(episodes)))
    columns = {name: np.concatenate([episode[name] for episode in episodes]) for name in episodes[0]}
    frames = len(columns["index"])
    columns["index"] = np.arange(frames)
    _write_table(folder / "data" / _FIRST, {name: _column(values) for name, values in columns.items()})
    lengths = [len(episode["index"]) for episode in episodes]
    _write_table(folder / "meta/episodes" / _FIRST, _episodes(selection.task, lengths, columns))
    _write_tasks(folder / "meta/tasks.parquet", selection.task.instruction)
    stats = {name: _statistics(values) for name, values in columns.items()}
    (folder / "meta/stats.json").write_text(json.dumps(stats, indent=2))
    (folder / "meta/info.json").write_text(json.dumps(_info(selection, columns, len(episodes)), indent=2))
    (folder / "meta/mart.json").write_text(json.dumps(_facts(selection), indent=2))
    return frames


def _frames(data: EpisodeData, selection: ExportSelection, number: int) -> Columns:
    """Return the columns of one episode."""
    count = len(data)
    frame = np.arange(count)
    seen = {
        part: np.concatenate(
            [data.observations[one.name][:-1].reshape(count, -1) for one in observations], axis=1
        ).astype(np.float32)
        for part, observations in _parts(selection.task).items()
    }
    return {
        **seen,
        "action": data.actions.reshape(count, -1).astype(np.float32),
        "source": data.sources.astype(np.int64),
        "engaged": data.engaged,
        "held": data.held,
        "recorded_tick": data.ticks[:-1],
        "next.reward": data.success[1:].astype(np.float32),
        "next.success": data.success[1:],
        "next.done": frame == count - 1,
        "timestamp": (frame / selection.control_hz).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.full(count, number),
        "index": frame,
        "task_index": np.zeros(count, dtype=np.int64),
    }


def _parts(task: Task) -> dict[str, list[Observation]]:
    own = [one for one in task.observations if one.name.partition("/")[0] in task.arm_names]
    rest = [one for one in task.observations if one not in own]
    return {"observation.state": own} | ({"observation.environment_state": rest} if rest else {})


def _column(values: NDArray[Any]) -> pa.Array:
    """Return a column; one number a row is a plain one, as LeRobot has it."""
    flat = pa.array(values.ravel())
    return (
        flat
        if values.ndim == 1 or values.shape[1] == 1
        else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
    )


def _episodes(task: Task, lengths: list[int], columns: Columns) -> Mapping[str, Any]:
    """Return a row for each episode, with its own statistics: LeRobot's tools make those of a data set from them."""
    ends = np.cumsum(lengths)
    zeros = [0] * len(lengths)
    return {
        "episode_index": list(range(len(lengths))),
        "tasks": [[task.instruction]] * len(lengths),
        "length": lengths,
        "data/chunk_index": zeros,
        "data/file_index": zeros,
        "dataset_from_index": ends - lengths,
        "dataset_to_index": ends,
        **_statistics_of_episodes(columns, ends),
        "meta/episodes/chunk_index": zeros,
        "meta/episodes/file_index": zeros,
    }


def _statistics_of_episodes(columns: Columns, ends: NDArray[np.int64]) -> dict[str, pa.Array]:
    """Return by `stats/{feature}/{statistic}` a list for each episode, for the index columns too."""
    found: dict[str, pa.Array] = {}
    for feature, values in columns.items():
        episodes = [_statistics(part) for part in np.split(values, ends[:-1])]
        for name in episodes[0]:
            kind = pa.list_(pa.int64() if name == "count" else pa.float64())
            found[f"stats/{feature}/{name}"] = pa.array([one[name] for one in episodes], type=kind)
    return found


def _write_tasks(path: Path, instruction: str) -> None:
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


def _statistics(values: NDArray[Any]) -> dict[str, list[float]]:
    """Return what policies are normalised with, a list for each."""
    rows = values.reshape(len(values), -1).astype(np.float64)
    found = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0)}
    quantiles = {
        f"q{percent:02d}": np.quantile(rows, percent / 100, axis=0) for percent in (1, 10, 50, 90, 99)
    }
    return {name: value.tolist() for name, value in (found | quantiles).items()} | {"count": [len(rows)]}


def _robots(task: Task) -> str:
    if not task.arm_kinds:
        return f"{len(task.arms)} Franka Pandas"  # as every version has called them
    return " + ".join(arm.kind.title for arm in task.arms)


def _facts(selection: ExportSelection) -> dict[str, Any]:
    """Return what LeRobot has no place for, and who seats a policy that was trained on it has to know."""
    task = selection.task
    kinds = {"arm_kinds": task.arm_kinds} if task.arm_kinds else {}
    return {"task": task.name, "control_hz": selection.control_hz, "arms": task.arm_names} | kinds


def _info(selection: ExportSelection, columns: Columns, episodes: int) -> dict[str, Any]:
    rate = selection.control_hz
    return {
        "codebase_version": _VERSION,
        "robot_type": _robots(selection.task),
        "total_episodes": episodes,
        "total_frames": len(columns["index"]),
        "total_tasks": 1,
        **_LIMITS,
        "fps": int(rate) if rate.is_integer() else rate,
        "splits": {"train": f"0:{episodes}"},
        "data_path": f"data/{_FILE}",
        "video_path": None,
        "features": {name: _feature(name, values, selection.task) for name, values in columns.items()},
    }


def _feature(name: str, values: NDArray[Any], task: Task) -> dict[str, Any]:
    names: list[str] | None = None
    if name == "action":
        names = [f"{arm}/action/{i}" for arm in task.arm_names for i in range(ACTION_SIZE)]
    elif name in ("source", "engaged", "held"):
        names = [f"{arm}/{name}" for arm in task.arm_names]
    for part, observations in _parts(task).items():
        if part == name:
            names = [f"{one.name}/{i}" for one in observations for i in range(int(np.prod(one.shape)))]
    return {"dtype": values.dtype.name, "shape": [*values.shape[1:]] or [1], "names": names}


def _write_table(path: Path, columns: Mapping[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.table(dict(columns)), path)
