"""Say what a checkpoint of LeRobot takes and gives, in MART's words: read from JSON. LeRobot is not needed for it.

Its `config.json` names features and their sizes, but not what each number is, nor the task and the rate. The data
set that it was trained on says so: `meta/info.json` and `meta/mart.json`, which `mart episodes export` writes. They are
looked for beside the checkpoint first, then in the data set that `train_config.json` names.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from mart.protocol.errors import Corrupt, NotFound

CONFIG, INFO, FACTS = "config.json", "info.json", "mart.json"
STATE, ENVIRONMENT, PICTURE, ACTION = (
    "observation.state", "observation.environment_state", "observation.images.", "action",
)  # fmt: skip
_MAX_BYTES = 16 * 1024 * 1024
_MAX_NUMBERS = 10_000

M = TypeVar("M", bound=BaseModel)
Size = Annotated[int, Field(ge=1, le=_MAX_NUMBERS)]


class _Feature(BaseModel):
    """A feature of a checkpoint: pictures are (channels, height, width)."""

    model_config = ConfigDict(frozen=True)

    type: str
    shape: tuple[Size, ...]


class CheckpointConfig(BaseModel):
    """What `config.json` says that matters here."""

    model_config = ConfigDict(frozen=True)

    type: str
    input_features: Mapping[str, _Feature]
    output_features: Mapping[str, _Feature]


class _DataFeature(BaseModel):
    model_config = ConfigDict(frozen=True)

    shape: tuple[Size, ...]
    names: tuple[str, ...] | None = None


class _DataInfo(BaseModel):
    model_config = ConfigDict(frozen=True)

    features: Mapping[str, _DataFeature]


class DataFacts(BaseModel):
    """What `meta/mart.json` says of a data set: the worlds that its episodes are of."""

    model_config = ConfigDict(frozen=True)

    task: str
    control_hz: float = Field(gt=0)
    arms: tuple[str, ...] = Field(min_length=1)
    arm_kinds: tuple[str, ...] = ()


class LeRobotCheckpoint(BaseModel):
    """A checkpoint, whole: what it takes, number by number, and what it gives.

    numbers: by feature (`observation.state`, …) the names of its numbers, such as `arm0/gripper/0`.
    pictures: by feature (height, width) in pixels; the last part of its name is the viewpoint.
    """

    model_config = ConfigDict(frozen=True)

    folder: Path
    kind: str
    facts: DataFacts
    numbers: Mapping[str, tuple[str, ...]]
    pictures: Mapping[str, tuple[int, int]]


def is_checkpoint(folder: Path) -> bool:
    """Return whether a folder looks like a checkpoint of LeRobot: by its files' names alone."""
    return (folder / CONFIG).is_file() and (folder / "model.safetensors").is_file()


def read_checkpoint(folder: Path) -> LeRobotCheckpoint:
    """Read what a checkpoint is. Raises NotFound where files are missing, Corrupt where they do not fit together."""
    config = _read(folder / CONFIG, CheckpointConfig)
    meta = _data_set_folder(folder)
    info, facts = _read(meta / INFO, _DataInfo), _read(meta / FACTS, DataFacts)
    numbers: dict[str, tuple[str, ...]] = {}
    pictures: dict[str, tuple[int, int]] = {}
    for name, feature in config.input_features.items():
        if name.startswith(PICTURE) and len(feature.shape) == 3 and feature.shape[0] == 3:
            pictures[name] = feature.shape[1:]
        else:
            numbers[name] = _names(folder, info, name, feature)
    action = config.output_features.get(ACTION)
    wanted = tuple(f"{arm}/action/{index}" for arm in facts.arms for index in range(7))
    if action is None or _names(folder, info, ACTION, action) != wanted:
        raise Corrupt(
            f"{folder} gives another action than {len(wanted)} numbers for {', '.join(facts.arms)}; train it on what "
            "`mart episodes export --format lerobot` wrote."
        )
    return LeRobotCheckpoint(folder=folder, kind=config.type, facts=facts, numbers=numbers, pictures=pictures)


def _names(folder: Path, info: _DataInfo, name: str, feature: _Feature) -> tuple[str, ...]:
    known = info.features.get(name)
    if known is None or known.names is None or (len(known.names),) != tuple(feature.shape):
        raise Corrupt(
            f"{folder} takes or gives {name} of shape {list(feature.shape)}, which its data set does not name number "
            "by number; train it on what `mart episodes export --format lerobot` wrote."
        )
    return known.names


def _data_set_folder(folder: Path) -> Path:
    if (folder / FACTS).is_file():
        return folder
    root = _training_root(folder)
    if root is not None and (root / "meta" / FACTS).is_file():
        return root / "meta"
    raise NotFound(
        f"{folder} does not say which task its numbers are of: copy `meta/{INFO}` and `meta/{FACTS}` of the data set "
        "that it was trained on beside its weights."
    )


def _training_root(folder: Path) -> Path | None:
    try:
        said: Any = json.loads((folder / "train_config.json").read_bytes())
        root = said["dataset"]["root"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return Path(root) if isinstance(root, str) else None


def _read(path: Path, kind: type[M]) -> M:
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise Corrupt(f"{path} is of more than {_MAX_BYTES} bytes; it is none of LeRobot's.")
        return kind.model_validate_json(path.read_bytes())
    except OSError as error:
        raise NotFound(f"There is no {path} that can be read ({error.strerror}).") from error
    except ValidationError as error:
        fault = error.errors()[0]
        where = ".".join(map(str, fault["loc"])) or "it"
        raise Corrupt(f"{path} cannot be understood: {where}: {fault['msg']}.") from error
