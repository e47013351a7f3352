"""Write robomimic's HDF5, as its 0.3 reads it (robomimic.github.io/docs/datasets/overview.html).

A demonstration is an episode, or a segment of one that people have edited. An observation of the catalogue is an
observation of robomimic's: `arm0/gripper` becomes `arm0_gripper`, since a slash would make a group. Nothing is
converted: quaternions stay wxyz, numbers float64. What robomimic has no place for is in attributes that it ignores.
"""

from __future__ import annotations

import json
import os
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from mart.episodes.arrays import EpisodeData
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Conflict
from mart.protocol.recording import OperatorsRecord
from mart.protocol.tasks import Task
from mart.recorder.export.cameras import CameraRequest
from mart.recorder.export.card import robomimic_card
from mart.recorder.export.holders import holder_column, told_holders
from mart.recorder.export.origins import GROUP, copy_origin, write_origin
from mart.recorder.export.pictures import DEPTH, RGB, SEGMENTATION, EpisodePictures
from mart.recorder.export.pieces import half_folder, write_pieces
from mart.recorder.export.selection import SOURCES, ExportSelection, read_segments

# robomimic.envs.env_base.EnvType.GYM_TYPE. It knows four types, and none of them makes a world of MART: its rollouts
# have to be off.
_GYM_TYPE = 2
_DEMOS = "demos.hdf5"
_CHANNELS = {RGB: 3, DEPTH: 1, SEGMENTATION: 1}
_TYPES = {RGB: np.uint8, DEPTH: np.float32, SEGMENTATION: np.int32}


def write_robomimic(selection: ExportSelection, path: Path) -> int:
    """Write the file and return how many transitions are in it; it has its name when it is whole.

    `PATH.md` beside it says what is in it. Raises Conflict as `half_folder` does, and what `read_segments` and
    `EpisodePictures` raise.
    """
    beside = path.with_suffix(".md")
    if beside.exists():
        raise Conflict(f"{beside} is there already; name another file or remove it.")
    with half_folder(path, selection.asked("robomimic")) as half:
        pieces = write_pieces(selection, half, write_piece)
        with h5py.File(half / "whole.hdf5", "w") as file:
            ticks, demos = _assemble(file, selection, pieces)
        (half / "card.md").write_text(robomimic_card(selection, demos, ticks, path.name), encoding="utf-8")
        os.replace(half / "card.md", beside)
        os.replace(half / "whole.hdf5", path)
    return ticks


def write_piece(selection: ExportSelection, episode: LabelledEpisode, folder: Path) -> None:
    """Write the demonstrations of one episode, a group for each of its segments."""
    pictures = EpisodePictures(episode.open(), selection.captured)
    with h5py.File(folder / _DEMOS, "w") as file:
        for number, data in enumerate(read_segments(selection, episode)):
            group = file.create_group(f"{number:04d}")
            _write_demo(group, data, episode, selection)
            _write_pictures(group, data, selection, pictures)
            write_origin(
                file.require_group(GROUP),
                group.name.strip("/"),
                data,
                episode,
                states=True,
                with_names=selection.with_names,
            )


def key_of(name: str) -> str:
    """Return the name in robomimic's files of an observation of the task catalogue."""
    return name.replace("/", "_")


def _assemble(file: h5py.File, selection: ExportSelection, pieces: Sequence[Path]) -> tuple[int, int]:
    """Copy the demonstrations as they are packed; returns how many transitions and demonstrations there are."""
    data = file.create_group("data")
    total, number, groups = 0, 0, defaultdict(list)
    for episode, piece in zip(selection.episodes, pieces, strict=True):
        in_data_sets = (f"dataset-{name}" for name in episode.datasets)
        keys = [*filter(None, (episode.outcome, episode.skill, *in_data_sets))]
        with h5py.File(piece / _DEMOS) as segments:
            for name in sorted(segments.keys() - {GROUP}):
                demo = f"demo_{number}"
                segments.copy(name, data, demo)
                copy_origin(segments[GROUP], name, file.require_group(GROUP), demo)
                total, number = total + int(data[demo].attrs["num_samples"]), number + 1
                for key in keys:
                    groups[key].append(demo)
    data.attrs["total"] = total
    data.attrs["env_args"] = json.dumps(_environment(selection))
    data.attrs["source"] = json.dumps(SOURCES)
    data.attrs["holders"] = json.dumps(told_holders(selection.holders, selection.with_names))
    data.attrs["observations"] = json.dumps(_observations(selection.task))
    for key, demos in groups.items():
        file[f"mask/{key}"] = np.array(demos, dtype="S")
    return total, number


def _write_demo(
    group: h5py.Group, data: EpisodeData, episode: LabelledEpisode, selection: ExportSelection
) -> None:
    last = np.arange(1, len(data) + 1) == len(data)
    group["states"] = data.integration_states[:-1]
    group["actions"] = data.actions.reshape(len(data), -1)
    group["rewards"] = data.success[1:].astype(np.float64)
    group["dones"] = last.astype(np.int64)
    group["source"] = data.sources
    group["ticks"] = data.ticks[:-1]
    group["held"] = data.held.astype(np.uint8)
    group["holder"] = holder_column(data, selection.holders)
    group["engaged"] = data.engaged.astype(np.uint8)
    for name, values in data.observations.items():
        group[f"obs/{key_of(name)}"] = values[:-1]
        group[f"next_obs/{key_of(name)}"] = values[1:]
    group.attrs["num_samples"] = len(data)
    group.attrs["episode"] = episode.file_path.name
    group.attrs["outcome"] = episode.outcome
    group.attrs["operators"] = json.dumps(_operators(episode, selection.with_names))


def _operators(episode: LabelledEpisode, with_names: bool) -> dict[str, str]:
    """Return who drove each arm, with changes; people's and policies' names only where they were asked for."""
    if with_names:
        return episode.operators
    return OperatorsRecord.from_strings(episode.operators).without_names().to_strings()


def _write_pictures(
    group: h5py.Group, data: EpisodeData, selection: ExportSelection, pictures: EpisodePictures
) -> None:
    """Write what each camera showed before and after each action, one picture in memory at a time."""
    kinds = {RGB: True, DEPTH: selection.depth, SEGMENTATION: selection.segmentation}
    for camera in selection.cameras:
        for kind in (kind for kind, wanted in kinds.items() if wanted):
            seen, after = (
                _picture_column(group[part], camera, kind, len(data)) for part in ("obs", "next_obs")
            )
            for row, picture in enumerate(pictures.of(data, camera, kind)):
                shaped = picture.reshape(seen.shape[1:])
                if row < len(data):
                    seen[row] = shaped
                if row > 0:
                    after[row - 1] = shaped
    if selection.cameras and selection.segmentation:
        group.attrs["bodies"] = json.dumps(pictures.bodies())


def _picture_column(group: h5py.Group, camera: CameraRequest, kind: str, rows: int) -> h5py.Dataset:
    """Make the data set, a chunk a picture: training takes rows at random, and each is unpacked by itself."""
    shape = (*camera.shape[:2], _CHANNELS[kind])
    name = f"{camera.key}_{kind}"
    return group.create_dataset(name, (rows, *shape), _TYPES[kind], chunks=(1, *shape), compression="gzip")


def _environment(selection: ExportSelection) -> dict[str, object]:
    task = selection.task
    arguments: dict[str, object] = {"control_hz": selection.control_hz, "arms": len(task.arms)}
    if task.arm_kinds:
        arguments["arm_kinds"] = dict(zip(task.arm_names, task.arm_kinds, strict=True))
    if selection.cameras:
        arguments["camera_names"] = [camera.key for camera in selection.cameras]
        arguments["camera_heights"] = [camera.height_px for camera in selection.cameras]
        arguments["camera_widths"] = [camera.width_px for camera in selection.cameras]
        arguments["captured_cameras"] = [
            one.key for one in selection.cameras if one.name in selection.captured
        ]
    return {"env_name": task.name, "type": _GYM_TYPE, "env_kwargs": arguments}


def _observations(task: Task) -> dict[str, object]:
    """Return by key the catalogue's name, shape and unit, and whose operators see it."""
    return {key_of(observation.name): asdict(observation) for observation in task.observations}
