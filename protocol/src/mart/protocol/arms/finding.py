"""Find the kinds of arms by name, and read their files."""

from __future__ import annotations

import os
import re
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mart.protocol.arms.robot_file import ArmKind
from mart.protocol.errors import InvalidInput, NotFound

SUFFIX = ".toml"
_MENAGERIE = "menagerie:"
_SHIPPED = Path(__file__).parent
_MAX_FILE_BYTES = 256 * 1024
_NAME = re.compile(r"[a-z][a-z0-9_]{0,62}")


def arms_folder() -> Path:
    """Return where people's own robot files are: MART_ARMS_DIR, or data/arms."""
    return Path(os.environ.get("MART_ARMS_DIR") or Path("data", "arms"))


def arm_kind_names() -> tuple[str, ...]:
    """Return the kinds that there are: those that come with MART, the Panda first, then people's own, then those of
    MuJoCo Menagerie, which are fetched when one is built."""
    shipped = sorted(_names_in(_SHIPPED), key=lambda name: (name != "panda", name))
    fetched = sorted(f"{_MENAGERIE}{name}" for name in _names_in(_SHIPPED / "menagerie"))
    return (*shipped, *sorted(_names_in(arms_folder()) - set(shipped)), *fetched)


def arm_kind(name: str) -> ArmKind:
    """Return the kind called `name`. Raises NotFound for an unknown one, InvalidInput where its file cannot be used."""
    path = _path_of(name)
    if path is None:
        raise NotFound.named("kind of arm", name[:64], arm_kind_names())
    return _load(path, path.stat().st_mtime_ns)


def load_robot_file(path: Path) -> ArmKind:
    """Read a robot file. Raises NotFound where there is none, InvalidInput with what is wrong in it and where."""
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
    name = f"{_MENAGERIE}{path.stem}" if path.parent == _SHIPPED / "menagerie" else path.stem
    try:
        kind = ArmKind.model_validate({**said, "name": name})
    except ValidationError as error:
        raise InvalidInput(f"{path} cannot be used: {_sentence(error)}") from error
    if kind.mjcf is None or kind.mjcf.menagerie is not None:
        return kind
    beside = str(path.parent.resolve() / kind.mjcf.file)
    return kind.model_copy(update={"mjcf": kind.mjcf.model_copy(update={"file": beside})})


@lru_cache(maxsize=64)
def _load(path: Path, _modified_ns: int) -> ArmKind:
    return load_robot_file(path)


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
