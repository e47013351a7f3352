"""Write beside a data set what it has no place for, so that `mart episodes import` makes the same episodes again.

It is an HDF5 group, in robomimic's file `mart`, in LeRobot's folder the file `meta/mart.hdf5`; their own readers pass
it by. Of each demonstration: what was after its last action, times, measured poses, subtasks, and the records of its
file.
"""

from __future__ import annotations

import json

import h5py
import numpy as np

from mart.episodes.arrays import EpisodeData
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import NotFound
from mart.protocol.recording import EpisodeRecord, OperatorsRecord, RoomRecord

GROUP = "mart"
DEMOS, MODELS = "demos", "models"
LAST_OBSERVATIONS, SUBTASKS = "last_observations", "subtasks"
RECORDS = (EpisodeRecord.NAME, RoomRecord.NAME, OperatorsRecord.NAME)
TASK_FILE = "task_file"
LAST_STATE, LAST_TICK = "last_state", "last_tick"
TIMES, SENT, SUCCESS = "sim_time_s", "sent_ns", "success"
POSITIONS, QUATERNIONS = "tool_positions_in_base", "tool_quaternions_in_base"


def write_origin(
    origins: h5py.Group,
    demo: str,
    data: EpisodeData,
    episode: LabelledEpisode,
    *,
    states: bool,
    with_names: bool,
) -> None:
    """Write what belongs to one demonstration.

    states: whether the data set has the integration states, too. with_names: whether people are named.
    """
    group = origins.create_group(f"{DEMOS}/{demo}")
    file = episode.open()
    for record in RECORDS:
        group.attrs[record] = json.dumps(_strings(file, record, with_names))
    group.attrs["outcome"] = episode.outcome
    group[TIMES], group[SENT], group[SUCCESS] = data.sim_time_s, data.sent_ns, data.success
    group[POSITIONS], group[QUATERNIONS] = data.tool_positions_in_base, data.tool_quaternions_in_base
    group[LAST_TICK] = data.ticks[-1]
    for name, done in data.subtasks.items():
        group[f"{SUBTASKS}/{name}"] = done
    for name, values in data.observations.items():
        group[f"{LAST_OBSERVATIONS}/{name.replace('/', '_')}"] = values[-1]
    text = file.task_file()
    if text is not None:
        group[TASK_FILE] = np.frombuffer(text, np.uint8)
    if states:
        group[LAST_STATE] = data.integration_states[-1]
        _write_model(origins, file)


def copy_origin(origins: h5py.Group, demo: str, target: h5py.Group, new: str) -> None:
    """Copy what belongs to one demonstration under a new name, and models that are not there yet."""
    origins.copy(f"{DEMOS}/{demo}", target.require_group(DEMOS), new)
    for sha256 in origins.get(MODELS, ()):
        if f"{MODELS}/{sha256}" not in target:
            origins.copy(f"{MODELS}/{sha256}", target.require_group(MODELS), sha256)


def _strings(file: EpisodeFile, record: str, with_names: bool) -> dict[str, str]:
    """Return what a record of the file says, of people only who they were to each other where nobody is to be named."""
    strings = dict(file.metadata.get(record, {}))
    if with_names:
        return strings
    if record == OperatorsRecord.NAME:
        return OperatorsRecord.from_strings(strings).without_names().to_strings()
    return {name: said for name, said in strings.items() if name != "ended_by_name"}


def _write_model(origins: h5py.Group, file: EpisodeFile) -> None:
    """Write a model once, however many demonstrations have it."""
    sha256 = file.room.model_sha256 or ""
    if not sha256 or f"{MODELS}/{sha256}" in origins:
        return
    try:
        mjb = file.model()
    except NotFound:
        return
    origins.create_dataset(f"{MODELS}/{sha256}", data=np.frombuffer(mjb, np.uint8), compression="gzip")
