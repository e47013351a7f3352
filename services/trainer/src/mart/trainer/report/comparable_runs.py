"""Hold two runs together that are to be compared: the same arms at the same rate."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from mart.protocol.errors import Corrupt, InvalidInput
from mart.trainer.train.run_directory import RunDirectory


def require_comparable(runs: Iterable[RunDirectory]) -> None:
    """Raise NotFound for what is no run, InvalidInput where tasks, kinds of arms or control rates differ.

    Only what a run says it learned from is looked at. Raises Corrupt where that cannot be read.
    """
    told = {str(run.path): _facts(run) for run in runs}
    if len({facts for facts in told.values() if facts}) > 1:
        listed = "; ".join(f"{path}: {facts or 'unknown'}" for path, facts in told.items())
        raise InvalidInput(
            f"Runs that cannot be compared were given ({listed}); give two of one task, arms and rate."
        )


def _facts(run: RunDirectory) -> str:
    _ = run.spec  # or NotFound, Corrupt
    if not run.data.is_file():
        return ""
    try:
        data: dict[str, Any] = json.loads(run.data.read_bytes())
        kinds = " and ".join(data.get("arm_kinds") or ("Pandas",))
        return f"{data['task']}, {kinds}, {data['control_hz']:g} Hz"
    except (ValueError, KeyError, TypeError) as error:
        raise Corrupt(f"{run.data} cannot be read; start a new run.") from error
