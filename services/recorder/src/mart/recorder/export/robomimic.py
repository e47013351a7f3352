"""robomimic's HDF5, as its 0.3 reads it (robomimic.github.io/docs/datasets/overview.html).

A demonstration is an episode, an observation of the catalogue is an observation of robomimic's: `arm0/gripper` becomes
`arm0_gripper`, since a slash would make a group. Nothing is converted: quaternions stay wxyz, numbers float64. What
robomimic has no place for is in attributes that it ignores.
"""

from __future__ import annotations

import json
import os
from collections import defaultdict
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Conflict
from mart.protocol.tasks import Task
from mart.recorder.catalogue.episode_catalogue import LabelledEpisode
from mart.recorder.export.selection import ExportSelection
from mart.recorder.export.transitions import Transitions, read_transitions

# robomimic.envs.env_base.EnvType.GYM_TYPE. It knows four types, and none of them makes a world of MART: its rollouts
# have to be off.
_GYM_TYPE = 2


def write_robomimic(choice: ExportSelection, path: Path) -> int:
    """How many transitions were written. The file has its name when it is whole.

    Raises Conflict where it is there already or cannot be written, and what read_transitions raises.
    """
    if path.exists():
        raise Conflict(f"{path} is there already; name another file or remove it.")
    half = path.with_name(path.name + ".half")
    try:
        with h5py.File(half, "w") as file:
            ticks = _write(file, choice)
        os.replace(half, path)
    except OSError as error:
        raise Conflict(f"{path} could not be written: {error}.") from error
    finally:
        half.unlink(missing_ok=True)
    return ticks


def key_of(name: str) -> str:
    """Of an observation of the catalogue, in robomimic's files."""
    return name.replace("/", "_")


def _write(file: h5py.File, choice: ExportSelection) -> int:
    data = file.create_group("data")
    total, groups = 0, defaultdict(list)
    for number, (episode, row) in enumerate(choice.episodes):
        demo = f"demo_{number}"
        transitions = read_transitions(episode, choice.task)
        _write_demo(data.create_group(demo), transitions, episode, row)
        total += len(transitions)
        for key in filter(None, (row.outcome, row.skill, *(f"dataset-{name}" for name in row.datasets))):
            groups[key].append(demo)
    data.attrs["total"] = total
    data.attrs["env_args"] = json.dumps(_environment(choice))
    data.attrs["observations"] = json.dumps(_observations(choice.task))
    for key, demos in groups.items():
        file[f"mask/{key}"] = np.array(demos, dtype="S")
    return total


def _write_demo(
    group: h5py.Group, transitions: Transitions, episode: EpisodeFile, row: LabelledEpisode
) -> None:
    last = np.arange(1, len(transitions) + 1) == len(transitions)
    group["states"] = transitions.states[:-1]
    group["actions"] = transitions.actions.reshape(len(transitions), -1)
    group["rewards"] = transitions.success.astype(np.float64)
    group["dones"] = last.astype(np.int64)
    for name, values in transitions.observations.items():
        group[f"obs/{key_of(name)}"] = values[:-1]
        group[f"next_obs/{key_of(name)}"] = values[1:]
    group.attrs["num_samples"] = len(transitions)
    group.attrs["episode"] = episode.path.name
    group.attrs["outcome"] = row.outcome
    group.attrs["operators"] = json.dumps(row.operators)


def _environment(choice: ExportSelection) -> dict[str, object]:
    arguments = {"control_hz": choice.control_hz, "arms": len(choice.task.arms)}
    return {"env_name": choice.task.name, "type": _GYM_TYPE, "env_kwargs": arguments}


def _observations(task: Task) -> dict[str, object]:
    """By key: the catalogue's name, shape and unit, and whose operators see it."""
    return {key_of(observation.name): asdict(observation) for observation in task.observations}
