"""Read what MART's own exports carry beside a data set: `export.origins` wrote it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Corrupt
from mart.protocol.recording import RoomRecord
from mart.recorder.export import origins
from mart.recorder.importing import hdf5
from mart.recorder.importing.foreign_episode import MAX_EPISODE_BYTES, MAX_MODEL_BYTES, OriginRows

_SHA256 = re.compile(r"[0-9a-f]{64}")
_MAX_TASK_FILE_BYTES = 1024 * 1024


def read_origin(file: h5py.Group, demo: str) -> OriginRows | None:
    """Read what belongs to one demonstration, None where nothing does. Raises Corrupt."""
    parts = [origins.GROUP, origins.DEMOS, demo]
    group: h5py.Group | None = file
    for part in parts:
        group = None if group is None else hdf5.group(group, part)
    if group is None:
        return None
    budget = hdf5.Budget(MAX_EPISODE_BYTES)
    records = {name: _strings(hdf5.said(group, name)) for name in origins.RECORDS}
    return OriginRows(
        records=records,
        outcome=hdf5.words(group, "outcome"),
        sim_time_s=_needed(group, origins.TIMES, budget).astype(np.float64),
        sent_ns=_needed(group, origins.SENT, budget).astype(np.int64),
        success=_needed(group, origins.SUCCESS, budget).astype(np.bool_),
        tool_positions_in_base=_needed(group, origins.POSITIONS, budget).astype(np.float64),
        tool_quaternions_in_base=_needed(group, origins.QUATERNIONS, budget).astype(np.float64),
        last_tick=int(_single(group, origins.LAST_TICK)),
        subtasks={k: v.astype(np.bool_) for k, v in _each(group, origins.SUBTASKS, budget).items()},
        last_observations={
            k: v.astype(np.float64).ravel()
            for k, v in _each(group, origins.LAST_OBSERVATIONS, budget).items()
        },
        last_state=_optional(group, origins.LAST_STATE, budget),
        mjb=_model(file, records[RoomRecord.NAME].get("model_sha256", "")),
        task_file=hdf5.octets(group, origins.TASK_FILE, _MAX_TASK_FILE_BYTES),
    )


def _model(file: h5py.Group, sha256: str) -> bytes | None:
    group = hdf5.group(file, origins.GROUP)
    models = None if group is None else hdf5.group(group, origins.MODELS)
    if models is None or not _SHA256.fullmatch(sha256):
        return None
    return hdf5.octets(models, sha256, MAX_MODEL_BYTES)


def _needed(group: h5py.Group, name: str, budget: hdf5.Budget) -> NDArray[Any]:
    found = hdf5.rows(group, name, budget=budget)
    if found is None:
        raise Corrupt(f"{group.name} has no {name!r}; it was written only in part.")
    return found


def _optional(group: h5py.Group, name: str, budget: hdf5.Budget) -> NDArray[np.float64] | None:
    found = hdf5.rows(group, name, budget=budget)
    return None if found is None else found.astype(np.float64)


def _single(group: h5py.Group, name: str) -> int:
    with hdf5.reading(f"{name!r} of {group.name}"):
        found = group.get(name, getlink=True)
        value = group[name] if isinstance(found, h5py.HardLink) else None
        if not isinstance(value, h5py.Dataset) or value.shape != () or value.dtype.kind not in "iu":
            raise Corrupt(f"{group.name} has no number {name!r}.")
        return int(value[()])


def _each(group: h5py.Group, name: str, budget: hdf5.Budget) -> dict[str, NDArray[Any]]:
    found = hdf5.group(group, name)
    return {} if found is None else {key: _needed(found, key, budget) for key in hdf5.names(found)}


def _strings(said: Any) -> Mapping[str, str]:
    if not isinstance(said, dict) or not all(isinstance(one, str) for one in said.values()):
        raise Corrupt("a record of the recorded episode is no map of texts.")
    return {str(key): value for key, value in said.items()}
