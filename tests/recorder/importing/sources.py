"""Foreign data sets made by hand, and what an import makes of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Unavailable
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.recorder.importing import lerobot, robomimic
from mart.recorder.importing.foreign_episode import NotImported
from mart.recorder.importing.import_episodes import Imported, ImportOrder, import_all
from mart.recorder.record.finalize import VerifyFile
from mart.recorder.verify.resimulation import nobody, verify

NOW_NS = 1_790_000_000_000_000_000


def unasked(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
    return verify(file, room, nobody(Unavailable("No replica was asked.")))


def imported(
    source: Path, out: Path, *, task: str | None = None, verify: VerifyFile = unasked
) -> list[Imported | NotImported]:
    """Import as the command does."""
    module = lerobot if source.is_dir() else robomimic
    order = ImportOrder(
        source=source,
        file_format=module.__name__.rpartition(".")[2],
        out=out,
        setting=module.read_setting(source),
        wanted_task=task,
        verify=verify,
        now_ns=NOW_NS,
        started_ns=NOW_NS,
    )
    return list(import_all(order, module.read_episodes(source)))


def only(report: list[Imported | NotImported]) -> Imported:
    (one,) = report
    assert isinstance(one, Imported), one
    return one


def why(report: list[Imported | NotImported]) -> str:
    (one,) = report
    assert isinstance(one, NotImported), one
    return one.why


def write_demo(path: Path, values: Mapping[str, Any], *, demo: str = "demo_0", env_args: str = "{}") -> None:
    """Write an HDF5 file with one demonstration, or add one to it: data sets by their names."""
    with h5py.File(path, "a") as file:
        group = file.require_group(f"data/{demo}")
        file["data"].attrs["env_args"] = env_args
        for name, value in values.items():
            group[name] = value


def write_folder(
    root: Path, frames: Mapping[str, Any], lengths: list[int], *, info: Mapping[str, Any] | None = None
) -> None:
    """Write a LeRobot folder: `frames` by feature, one row a frame, cut into episodes of these lengths."""
    count = sum(lengths)
    columns = {
        "episode_index": np.repeat(np.arange(len(lengths)), lengths),
        "frame_index": np.concatenate([np.arange(n) for n in lengths]) if lengths else np.zeros(0, int),
        **{name: np.asarray(values)[:count] for name, values in frames.items()},
    }
    features = {
        name: {"dtype": str(values.dtype), "shape": [*values.shape[1:]] or [1], "names": None}
        for name, values in columns.items()
    }
    said = {"codebase_version": "v3.0", "fps": 10, "features": features} | dict(info or {})
    (root / "meta/episodes/chunk-000").mkdir(parents=True)
    (root / "data/chunk-000").mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(said))
    pq.write_table(
        pa.table({n: _column(v) for n, v in columns.items()}), root / "data/chunk-000/file-000.parquet"
    )
    episodes = {
        "episode_index": range(len(lengths)),
        "length": lengths,
        "tasks": [["fold it"]] * len(lengths),
    }
    pq.write_table(
        pa.table({name: list(values) for name, values in episodes.items()}),
        root / "meta/episodes/chunk-000/file-000.parquet",
    )


def _column(values: Any) -> pa.Array:
    flat = pa.array(values.ravel())
    return flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
