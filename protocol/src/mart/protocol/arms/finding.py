"""Find the kinds of arms and their end effectors by name, and read their files."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from mart.protocol.arms.end_effector import EndEffector
from mart.protocol.arms.robot_file import ArmKind
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.toml_files import SUFFIX, FileSort, is_name, names_in

_MENAGERIE = "menagerie:"
_SHIPPED = Path(__file__).parent
_END_EFFECTORS = "end_effectors"  # their folder, beside the robot files
_USUAL = "two_finger"
_PLUS = "+"
_ROBOT = FileSort(
    "robot file",
    "`mart arms list` names the kinds that there are",
    "how-to-bring-your-own-robot",
    most_bytes=256 * 1024,
)
_END_EFFECTOR = replace(_ROBOT, title="end-effector file")


def arms_folder() -> Path:
    """Return where people's own robot files are: MART_ARMS_DIR, or data/arms."""
    return Path(os.environ.get("MART_ARMS_DIR") or Path("data", "arms"))


def arm_kind_names() -> tuple[str, ...]:
    """Return the kinds that there are: those that come with MART, the Panda first, then people's own, then those of
    MuJoCo Menagerie, which are fetched when one is built."""
    shipped = sorted(names_in(_SHIPPED), key=lambda name: (name != "panda", name))
    fetched = sorted(f"{_MENAGERIE}{name}" for name in names_in(_SHIPPED / "menagerie"))
    return (*shipped, *sorted(names_in(arms_folder()) - set(shipped)), *fetched)


def end_effector_names() -> tuple[str, ...]:
    """Return the end effectors that there are: the usual one first, the others of MART, then people's own."""
    shipped = sorted(names_in(_SHIPPED / _END_EFFECTORS), key=lambda name: (name != _USUAL, name))
    return (*shipped, *sorted(names_in(arms_folder() / _END_EFFECTORS) - set(shipped)))


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
    folders = (_SHIPPED, arms_folder()) if is_name(name) else ()
    paths = (folder / _END_EFFECTORS / f"{name}{SUFFIX}" for folder in folders)
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        raise NotFound.named("end effector", name[:64], end_effector_names())
    return _load_end_effector(path, path.stat().st_mtime_ns)


def load_robot_file(path: Path) -> ArmKind:
    """Read a robot file. Raises NotFound where there is none, InvalidInput with what is wrong in it and where."""
    said = _ROBOT.table(_ROBOT.read(path), str(path))
    name = f"{_MENAGERIE}{path.stem}" if path.parent == _SHIPPED / "menagerie" else path.stem
    held = said.pop("end_effector", _USUAL)
    try:
        said["end_effector"] = end_effector(str(held))
    except NotFound as error:
        raise InvalidInput(f"{path} cannot be used: end_effector: {error}") from error
    kind = _ROBOT.checked(ArmKind, {**said, "name": name}, str(path))
    if kind.mjcf is None or kind.mjcf.menagerie is not None:
        return kind
    beside = str(path.parent.resolve() / kind.mjcf.file)
    return kind.model_copy(update={"mjcf": kind.mjcf.model_copy(update={"file": beside})})


def load_end_effector_file(path: Path) -> EndEffector:
    """Read an end-effector file. Raises NotFound where there is none, InvalidInput with what is wrong and where."""
    said = _END_EFFECTOR.table(_END_EFFECTOR.read(path), str(path))
    return _END_EFFECTOR.checked(EndEffector, {**said, "name": path.stem}, str(path))


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
        return path if is_name(plain) and path.is_file() else None
    if not is_name(name):
        return None
    paths = (folder / f"{name}{SUFFIX}" for folder in (_SHIPPED, arms_folder()))
    return next((path for path in paths if path.is_file()), None)


PANDA = arm_kind("panda")
