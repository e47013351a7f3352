"""Write LeRobot's data sets of version 3: a folder of Parquet, JSON, and MP4 where pictures are asked for.

The format is that of huggingface.co/docs/lerobot/lerobot-dataset-v3.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Task
from mart.recorder.export.cameras import CameraRequest
from mart.recorder.export.card import lerobot_card
from mart.recorder.export.columns import Columns, columns_of, feature_of
from mart.recorder.export.holders import told_holders
from mart.recorder.export.lerobot_tables import (
    CHUNK_SIZE,
    DATA_FILE,
    DATA_MB,
    VIDEO_FILE,
    VIDEO_MB,
    SegmentPart,
    place,
    write_data,
    write_episodes,
    write_tasks,
)
from mart.recorder.export.origins import DEMOS, GROUP, write_origin
from mart.recorder.export.pictures import EpisodePictures
from mart.recorder.export.pieces import half_folder, write_pieces
from mart.recorder.export.selection import ExportSelection, read_segments
from mart.recorder.export.statistics import of_numbers, of_pictures
from mart.recorder.export.videos import video_info, write_video

VERSION = "v3.0"
_COLUMNS = "columns.npz"
_ORIGIN = "origin.hdf5"


def write_lerobot(selection: ExportSelection, path: Path) -> int:
    """Write the folder and return how many frames are in it; it has its name when it is whole.

    Raises Conflict as `half_folder` does, InvalidInput where pictures are asked for that LeRobot has no place for, and
    what `read_segments` and `EpisodePictures` raise.
    """
    _require_fit(selection)
    path.parent.mkdir(parents=True, exist_ok=True)
    with half_folder(path, selection.asked("lerobot")) as half:
        pieces = write_pieces(selection, half, write_piece)
        parts = [_part(folder, selection) for piece in pieces for folder in sorted(piece.iterdir())]
        shutil.rmtree(half / "whole", ignore_errors=True)  # of an export that was interrupted late
        frames = _assemble(selection, parts, half / "whole", path.name)
        os.replace(half / "whole", path)
    return frames


def feature_name(camera: CameraRequest) -> str:
    """Return what LeRobot calls the pictures of a camera."""
    return f"observation.images.{camera.key}"


def write_piece(selection: ExportSelection, episode: LabelledEpisode, folder: Path) -> None:
    """Write a folder for each segment of an episode: its columns, a video a camera and what colours are in it."""
    pictures = EpisodePictures(episode.open(), selection.captured)
    segments = read_segments(selection, episode, with_integration_states=bool(selection.cameras))
    for number, data in enumerate(segments):
        segment = folder / f"{number:04d}"
        segment.mkdir()
        for camera in selection.cameras:
            drawn = islice(pictures.of(data, camera), len(data))
            counts = write_video(segment / f"{camera.key}.mp4", drawn, camera, int(selection.control_hz))
            np.save(segment / f"{camera.key}.npy", counts)
        columns: dict[str, Any] = columns_of(data, selection.task, selection.control_hz, selection.holders)
        np.savez(segment / _COLUMNS, **columns)
        with h5py.File(segment / _ORIGIN, "w") as file:
            write_origin(
                file.create_group(GROUP), "0", data, episode, states=False, with_names=selection.with_names
            )


def _part(folder: Path, selection: ExportSelection) -> SegmentPart:
    with np.load(folder / _COLUMNS) as found:
        columns = dict(found)
    counts = {feature_name(camera): np.load(folder / f"{camera.key}.npy") for camera in selection.cameras}
    videos = {feature_name(camera): folder / f"{camera.key}.mp4" for camera in selection.cameras}
    return SegmentPart(columns, counts, videos, folder / _ORIGIN)


def _assemble(selection: ExportSelection, parts: Sequence[SegmentPart], folder: Path, name: str) -> int:
    """Put the parts together; videos are linked, so that whoever is interrupted here loses none."""
    begin = 0
    for number, part in enumerate(parts):
        part.columns["episode_index"][:] = number
        part.columns["index"] = begin + np.arange(len(part))
        begin += len(part)
    write_data(folder, parts)
    write_episodes(folder, parts, selection.task.instruction, selection.control_hz)
    write_tasks(folder / "meta/tasks.parquet", selection.task.instruction)
    for number, part in enumerate(parts):
        for feature, video in part.videos.items():
            chunk, file = place(number)
            target = folder / VIDEO_FILE.format(video_key=feature, chunk_index=chunk, file_index=file)
            target.parent.mkdir(parents=True, exist_ok=True)
            _link(video, target)
    columns = {name: np.concatenate([part.columns[name] for part in parts]) for name in parts[0].columns}
    info = _info(selection, columns, len(parts))
    _write_json(folder / "meta/stats.json", _statistics(columns, parts))
    _write_json(folder / "meta/info.json", info)
    _write_json(folder / "meta/mart.json", _facts(selection))
    _write_origins(folder / "meta/mart.hdf5", parts)
    (folder / "README.md").write_text(lerobot_card(selection, info, name), encoding="utf-8")
    return begin


def _link(video: Path, target: Path) -> None:
    try:
        os.link(video, target)
    except OSError:  # a file system that has no links
        shutil.copyfile(video, target)


def _statistics(columns: Columns, parts: Sequence[SegmentPart]) -> dict[str, Any]:
    numbers = {name: of_numbers(values) for name, values in columns.items()}
    frames = sum(map(len, parts))
    colours = {
        feature: of_pictures(
            sum((part.counts[feature] for part in parts[1:]), parts[0].counts[feature]), frames
        )
        for feature in parts[0].counts
    }
    return numbers | colours


def _info(selection: ExportSelection, columns: Columns, episodes: int) -> dict[str, Any]:
    rate = selection.control_hz
    features = {name: feature_of(name, values, selection.task) for name, values in columns.items()}
    videos = {
        feature_name(camera): {
            "dtype": "video",
            "shape": [*camera.shape],
            "names": ["height", "width", "channels"],
            "info": video_info(camera, int(rate)),
        }
        for camera in selection.cameras
    }
    return {
        "codebase_version": VERSION,
        "robot_type": _robots(selection.task),
        "total_episodes": episodes,
        "total_frames": len(columns["index"]),
        "total_tasks": 1,
        "chunks_size": CHUNK_SIZE,
        "data_files_size_in_mb": DATA_MB,
        "video_files_size_in_mb": VIDEO_MB,
        "fps": int(rate) if rate.is_integer() else rate,
        "splits": {"train": f"0:{episodes}"},
        "data_path": DATA_FILE,
        "video_path": VIDEO_FILE if videos else None,
        "features": videos | features,
    }


def _facts(selection: ExportSelection) -> dict[str, Any]:
    """Return what LeRobot has no place for, and who seats a policy that was trained on it has to know."""
    task = selection.task
    kinds = {"arm_kinds": task.arm_kinds} if task.arm_kinds else {}
    return {
        "task": task.name,
        "control_hz": selection.control_hz,
        "arms": task.arm_names,
        "holders": told_holders(selection.holders, selection.with_names),
        **kinds,
    }


def _write_origins(path: Path, parts: Sequence[SegmentPart]) -> None:
    """Write what `mart episodes import` makes the same episodes of again."""
    with h5py.File(path, "w") as file:
        demos = file.create_group(f"{GROUP}/{DEMOS}")
        for number, part in enumerate(parts):
            with h5py.File(part.origin) as origin:
                origin.copy(f"{GROUP}/{DEMOS}/0", demos, f"episode_{number}")


def _robots(task: Task) -> str:
    if not task.arm_kinds:
        return f"{len(task.arms)} Franka Pandas"  # as every version has called them
    return " + ".join(arm.kind.title for arm in task.arms)


def _require_fit(selection: ExportSelection) -> None:
    if selection.depth or selection.segmentation:
        raise InvalidInput(
            "LeRobot's data sets have no sound place for depth or segmentation: its videos are lossy, and 8 bits deep. "
            "Leave --depth and --segmentation out, or export --format robomimic."
        )
    if selection.cameras and not selection.control_hz.is_integer():
        raise InvalidInput(
            f"LeRobot's videos have a whole number of pictures a second, and {selection.control_hz:g} was asked for; "
            "give --control-hz such a rate, such as 10."
        )


def _write_json(path: Path, content: Any) -> None:
    path.write_text(json.dumps(content, indent=2))
