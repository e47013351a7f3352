"""Who drives which arm in a collection: `--operators script,policy:PATH`. Pure, but for the look at the disk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task

_SCRIPT = "script"
_POLICY = "policy:"
_FILE = "checkpoint.json"


@dataclass(frozen=True)
class SeatOperators:
    """Tell who drives: `scripts`, arms of emulated people; `policies`, arms by the checkpoint that drives them."""

    scripts: tuple[str, ...]
    policies: Mapping[Path, tuple[str, ...]] = field(default_factory=dict)


def parse_operators(task: str, given: str | None) -> SeatOperators:
    """One operator an arm, separated by commas; None: a script for each.

    Raises NotFound for an unknown operator or a checkpoint that does not exist, InvalidInput where the number is not
    the task's or nobody is left to begin episodes.
    """
    arms = tuple(arm.name for arm in get_task(task).arms)
    if given is None:
        return SeatOperators(arms)
    names = given.split(",")
    if len(names) != len(arms):
        raise InvalidInput(
            f"{len(names)} operators were given; {task} has {len(arms)} arms: name one for each."
        )
    scripts: list[str] = []
    policies: dict[Path, tuple[str, ...]] = {}
    for arm, name in zip(arms, names, strict=True):
        if name == _SCRIPT:
            scripts.append(arm)
        else:
            checkpoint = _checkpoint(name)
            policies[checkpoint] = (*policies.get(checkpoint, ()), arm)
    if not scripts:
        raise InvalidInput(
            "Only policies were given; somebody has to begin each episode: name a script for at least one arm. "
            "`mart eval` judges policies that drive every arm."
        )
    return SeatOperators(tuple(scripts), policies)


def _checkpoint(operator: str) -> Path:
    path = operator.removeprefix(_POLICY)
    if path == operator:
        raise NotFound.named("operator for collecting", operator, [_SCRIPT, f"{_POLICY}PATH"])
    if not (Path(path) / _FILE).is_file():
        raise NotFound(f"There is no checkpoint {path}; name a directory that holds {_FILE}.")
    return Path(path)
