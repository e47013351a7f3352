"""Read robomimic's HDF5 (0.3): MART's own exports with all that they carry, other people's as numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mart.protocol.errors import Corrupt
from mart.recorder.importing import hdf5
from mart.recorder.importing.file_digest import sha256_of
from mart.recorder.importing.foreign_episode import (
    MAX_EPISODE_BYTES,
    Array,
    ForeignEpisode,
    NotImported,
    Setting,
)
from mart.recorder.importing.origin_reading import read_origin
from mart.recorder.importing.setting import from_arguments

_DEMO = re.compile(r"demo_?([0-9]{1,9})")


def read_setting(path: Path) -> Setting:
    """Read of what the data set is. Raises NotFound and Corrupt."""
    with hdf5.opened(path) as file:
        arguments = hdf5.said(_data(file, path), "env_args")
    if not isinstance(arguments, dict):
        return Setting()
    inner = arguments.get("env_kwargs")
    return from_arguments(arguments.get("env_name"), inner if isinstance(inner, dict) else {})


def read_episodes(path: Path) -> Iterator[ForeignEpisode | NotImported]:
    """Iterate over the demonstrations in the order of their numbers, one in memory at a time.

    One that cannot be used is told of instead. Raises NotFound, and Corrupt where nothing of the file can be used.
    """
    digest = sha256_of(path)
    with hdf5.opened(path) as file:
        data = _data(file, path)
        origins = file if hdf5.group(file, "mart") is not None else None
        for place, demo in enumerate(sorted(hdf5.names(data), key=_order)):
            try:
                origin = None if origins is None else read_origin(origins, demo)
                yield replace(_read(data, demo, path, digest), number=place, origin=origin)
            except Corrupt as error:
                yield NotImported(demo, str(error))


def _data(file: h5py.File, path: Path) -> h5py.Group:
    data = hdf5.group(file, "data")
    if data is None:
        raise Corrupt(f"{path} has no group 'data'; it is no data set of robomimic's.")
    return data


def _order(name: str) -> tuple[int, str]:
    match = _DEMO.fullmatch(name)
    return (int(match[1]) if match else 2**31, name)


def _read(data: h5py.Group, demo: str, path: Path, digest: str) -> ForeignEpisode:
    group = hdf5.group(data, demo)
    if group is None:
        raise Corrupt("it is not there.")
    budget = hdf5.Budget(MAX_EPISODE_BYTES)
    actions = _numbers(group, "actions", budget)
    if actions is None or not len(actions):
        raise Corrupt("it has no actions.")
    count = len(actions)
    left_out: list[str] = []
    seen = _observations(group, "obs", count, budget, left_out)
    after = _observations(group, "next_obs", count, budget, [])
    operators = hdf5.said(group, "operators")
    flags = {name: _column(group, name, count, budget) for name in ("source", "engaged", "ticks", "rewards")}
    return ForeignEpisode(
        name=demo,
        number=0,
        source_file=path.name,
        source_sha256=digest,
        observations=seen,
        actions=actions,
        last={key: values[-1] for key, values in after.items()} if seen.keys() == after.keys() else None,
        success=None if flags["rewards"] is None else flags["rewards"] > 0,
        sources=None if flags["source"] is None else flags["source"].astype(np.int64),
        engaged=None if flags["engaged"] is None else flags["engaged"] > 0,
        ticks=None if flags["ticks"] is None else flags["ticks"].astype(np.int64),
        states=_of_length(_numbers(group, "states", budget), "states", count),
        outcome=hdf5.words(group, "outcome"),
        operators=_strings(operators),
        left_out=tuple(left_out),
    )


def _observations(
    group: h5py.Group, name: str, count: int, budget: hdf5.Budget, left_out: list[str]
) -> dict[str, Array]:
    found = hdf5.group(group, name)
    if found is None:
        return {}
    taken: dict[str, Array] = {}
    for key in hdf5.names(found):
        try:
            values = _of_length(_numbers(found, key, budget), key, count)
        except hdf5.TooWide as error:
            left_out.append(str(error))
        else:
            assert values is not None
            taken[key] = values
    return taken


def _numbers(group: h5py.Group, name: str, budget: hdf5.Budget) -> Array | None:
    """Return float64[rows, width]."""
    values = hdf5.rows(group, name, budget=budget)
    if values is None:
        return None
    return values.astype(np.float64).reshape(len(values), int(np.prod(values.shape[1:])))


def _column(group: h5py.Group, name: str, count: int, budget: hdf5.Budget) -> Any:
    return _of_length(hdf5.rows(group, name, budget=budget), name, count)


def _of_length(values: Any, name: str, count: int) -> Any:
    if values is not None and len(values) != count:
        raise Corrupt(f"{name!r} has {len(values)} rows and 'actions' has {count}; they must be as many.")
    return values


def _strings(said: Any) -> Mapping[str, str]:
    return {str(k): v for k, v in said.items() if isinstance(v, str)} if isinstance(said, dict) else {}
