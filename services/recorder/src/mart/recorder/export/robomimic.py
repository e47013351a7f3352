"""Write robomimic's HDF5, as its 0.3 reads it (robomimic.github.io/docs/datasets/overview.html).

A demonstration is an episode, or a segment of one that people have edited. An observation of the catalogue is an
observation of robomimic's: `arm0/gripper` becomes `arm0_gripper`, since a slash would make a group. Nothing is
converted: quaternions stay wxyz, numbers float64. What robomimic has no place for is in attributes that it ignores.
"""

from __future__ import annotations

import json
import os
from collections import defaultdict
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from mart.episodes.arrays import EpisodeData
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Conflict
from mart.protocol.tasks import Task
from mart.recorder.export.origins import GROUP, write_origin
from mart.recorder.export.selection import SOURCES, ExportSelection, read_segments

# robomimic.envs.env_base.EnvType.GYM_TYPE. It knows four types, and none of them makes a world of MART: its rollouts
# have to be off.
_GYM_TYPE = 2


def write_robomimic(selection: ExportSelection, path: Path) -> int:
    """Write the file and return how many transitions are in it; it has its name when it is whole.

    Raises Conflict where it is there already or cannot be written, and what `read_segments` raises.
    """
    if path.exists():
        raise Conflict(f"{path} is there already; name another file or remove it.")
    half = path.with_name(path.name + ".half")
    try:
        with h5py.File(half, "w") as file:
            ticks = _write(file, selection)
        os.replace(half, path)
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error}.") from error
    finally:
        half.unlink(missing_ok=True)
    return ticks


def key_of(name: str) -> str:
    """Return the name in robomimic's files of an observation of the task catalogue."""
    return name.replace("/", "_")


def _write(file: h5py.File, selection: ExportSelection) -> int:
    data = file.create_group("data")
    total, number, groups = 0, 0, defaultdict(list)
    for episode in selection.each(selection.episodes):
        in_data_sets = (f"dataset-{name}" for name in episode.datasets)
        keys = [*filter(None, (episode.outcome, episode.skill, *in_data_sets))]
        for segment in read_segments(selection, episode):
            demo = f"demo_{number}"
            _write_demo(data.create_group(demo), segment, episode)
            write_origin(file.require_group(GROUP), demo, segment, episode, states=True)
            total, number = total + len(segment), number + 1
            for key in keys:
                groups[key].append(demo)
    data.attrs["total"] = total
    data.attrs["env_args"] = json.dumps(_environment(selection))
    data.attrs["source"] = json.dumps(SOURCES)
    data.attrs["observations"] = json.dumps(_observations(selection.task))
    for key, demos in groups.items():
        file[f"mask/{key}"] = np.array(demos, dtype="S")
    return total


def _write_demo(group: h5py.Group, data: EpisodeData, episode: LabelledEpisode) -> None:
    last = np.arange(1, len(data) + 1) == len(data)
    group["states"] = data.integration_states[:-1]
    group["actions"] = data.actions.reshape(len(data), -1)
    group["rewards"] = data.success[1:].astype(np.float64)
    group["dones"] = last.astype(np.int64)
    group["source"] = data.sources
    group["ticks"] = data.ticks[:-1]
    group["engaged"] = data.engaged.astype(np.uint8)
    group["held"] = data.held.astype(np.uint8)
    for name, values in data.observations.items():
        group[f"obs/{key_of(name)}"] = values[:-1]
        group[f"next_obs/{key_of(name)}"] = values[1:]
    group.attrs["num_samples"] = len(data)
    group.attrs["episode"] = episode.file_path.name
    group.attrs["outcome"] = episode.outcome
    group.attrs["operators"] = json.dumps(episode.operators)


def _environment(selection: ExportSelection) -> dict[str, object]:
    task = selection.task
    arguments: dict[str, object] = {"control_hz": selection.control_hz, "arms": len(task.arms)}
    if task.arm_kinds:
        arguments["arm_kinds"] = dict(zip(task.arm_names, task.arm_kinds, strict=True))
    return {"env_name": task.name, "type": _GYM_TYPE, "env_kwargs": arguments}


def _observations(task: Task) -> dict[str, object]:
    """Return by key the catalogue's name, shape and unit, and whose operators see it."""
    return {key_of(observation.name): asdict(observation) for observation in task.observations}
