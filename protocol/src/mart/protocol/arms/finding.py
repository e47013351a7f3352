"""Find the kinds of arms and their end effectors by name, and read their files."""

from __future__ import annotations

import os
import re
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from mart.protocol.arms.end_effector import EndEffector
from mart.protocol.arms.robot_file import ArmKind
from mart.protocol.errors import InvalidInput, NotFound

SUFFIX = ".toml"
_MENAGERIE = "menagerie:"
_SHIPPED = Path(__file__).parent
_END_EFFECTORS = "end_effectors"  # their folder, beside the robot files
_USUAL = "two_finger"
_PLUS = "+"
_MAX_FILE_BYTES = 256 * 1024
_NAME = re.compile(r"[a-z][a-z0-9_]{0,62}")

_Model = TypeVar("_Model", bound=BaseModel)


def arms_folder() -> Path:
    """Return where people's own robot files are: MART_ARMS_DIR, or data/arms."""
    return Path(os.environ.get("MART_ARMS_DIR") or Path("data", "arms"))


def arm_kind_names() -> tuple[str, ...]:
    """Return the kinds that there are: those that come with MART, the Panda first, then people's own, then those of
    MuJoCo Menagerie, which are fetched when one is built."""
    shipped = sorted(_names_in(_SHIPPED), key=lambda name: (name != "panda", name))
    fetched = sorted(f"{_MENAGERIE}{name}" for name in _names_in(_SHIPPED / "menagerie"))
    return (*shipped, *sorted(_names_in(arms_folder()) - set(shipped)), *fetched)


def end_effector_names() -> tuple[str, ...]:
    """Return the end effectors that there are: the usual one first, the others of MART, then people's own."""
    shipped = sorted(_names_in(_SHIPPED / _END_EFFECTORS), key=lambda name: (name != _USUAL, name))
    return (*shipped, *sorted(_names_in(arms_folder() / _END_EFFECTORS) - set(shipped)))


def arm_kind(name: str) -> ArmKind:
    """Return the kind called `name`, which may say an end effector after a plus sign: `ur5e+wiping_pad`.

    Raises NotFound for an unknown one, InvalidInput where a file cannot be used.
    """
    arm, plus, said = name.partition(_PLUS)
    path = _path_of(arm)
    if path is None:
        raise NotFound.named("kind of arm", arm[:64], arm_kind_names())
    kind = _load(path, path.stat().st_mtime_ns)
    if plus:
        return kind.with_end_effector(end_effector(said))
    own = end_effector(kind.end_effector.name)
    return kind if own is kind.end_effector else kind.model_copy(update={"end_effector": own})


def end_effector(name: str) -> EndEffector:
    """Return the end effector called `name`. Raises NotFound for an unknown one, InvalidInput for a bad file."""
    folders = (_SHIPPED, arms_folder()) if _NAME.fullmatch(name) else ()
    paths = (folder / _END_EFFECTORS / f"{name}{SUFFIX}" for folder in folders)
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        raise NotFound.named("end effector", name[:64], end_effector_names())
    return _load_end_effector(path, path.stat().st_mtime_ns)


def load_robot_file(path: Path) -> ArmKind:
    """Read a robot file. Raises NotFound where there is none, InvalidInput with what is wrong in it and where."""
    said = _read(path)
    name = f"{_MENAGERIE}{path.stem}" if path.parent == _SHIPPED / "menagerie" else path.stem
    held = said.pop("end_effector", _USUAL)
    try:
        said["end_effector"] = end_effector(str(held))
    except NotFound as error:
        raise InvalidInput(f"{path} cannot be used: end_effector: {error}") from error
    kind = _checked(path, ArmKind, {**said, "name": name})
    if kind.mjcf is None or kind.mjcf.menagerie is not None:
        return kind
    beside = str(path.parent.resolve() / kind.mjcf.file)
    return kind.model_copy(update={"mjcf": kind.mjcf.model_copy(update={"file": beside})})


def load_end_effector_file(path: Path) -> EndEffector:
    """Read an end-effector file. Raises NotFound where there is none, InvalidInput with what is wrong and where."""
    return _checked(path, EndEffector, {**_read(path), "name": path.stem})


def _read(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise NotFound(f"There is no robot file {path}; `mart arms list` names the kinds that there are.")
    if not _NAME.fullmatch(path.stem) or path.suffix != SUFFIX:
        raise InvalidInput(
            f"{path.name} cannot be a robot file's name: use small letters, digits and underscores, then {SUFFIX}."
        )
    if path.stat().st_size > _MAX_FILE_BYTES:
        raise InvalidInput(
            f"{path} is larger than {_MAX_FILE_BYTES // 1024} KiB; a robot file holds text alone."
        )
    try:
        said: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidInput(f"{path} is not TOML: {error}.") from error
    if "name" in said:
        raise InvalidInput(f"{path} says a name; a robot is called as its file is: leave the line out.")
    return said


def _checked(path: Path, model: type[_Model], said: dict[str, Any]) -> _Model:
    try:
        return model.model_validate(said)
    except ValidationError as error:
        raise InvalidInput(f"{path} cannot be used: {_sentence(error)}") from error


@lru_cache(maxsize=64)
def _load(path: Path, _modified_ns: int) -> ArmKind:
    return load_robot_file(path)


@lru_cache(maxsize=64)
def _load_end_effector(path: Path, _modified_ns: int) -> EndEffector:
    return load_end_effector_file(path)


def _path_of(name: str) -> Path | None:
    if name.startswith(_MENAGERIE):
        plain = name.removeprefix(_MENAGERIE)
        path = _SHIPPED / "menagerie" / f"{plain}{SUFFIX}"
        return path if _NAME.fullmatch(plain) and path.is_file() else None
    if not _NAME.fullmatch(name):
        return None
    paths = (folder / f"{name}{SUFFIX}" for folder in (_SHIPPED, arms_folder()))
    return next((path for path in paths if path.is_file()), None)


def _names_in(folder: Path) -> set[str]:
    return {path.stem for path in folder.glob(f"*{SUFFIX}") if _NAME.fullmatch(path.stem)}


def _sentence(error: ValidationError) -> str:
    """Say the first mistake: where, and what is wrong."""
    first = error.errors()[0]
    where = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in first["loc"])
    message = first["msg"].removeprefix("Value error, ").rstrip(".")
    return f"{where.lstrip('.')}: {message}." if where else f"{message}."


PANDA = arm_kind("panda")
