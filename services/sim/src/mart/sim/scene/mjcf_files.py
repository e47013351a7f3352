"""Read somebody's MJCF scene with all files that it names, bounded, and none from outside its own folder.

The XML is looked through before MuJoCo sees it: every file that it includes or loads has to lie in the folder of the
MJCF or below, and all of them are handed to MuJoCo as bytes, so that it opens none itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco

from mart.protocol.errors import InvalidInput, NotFound

MAX_XML_BYTES = 1024 * 1024
MAX_ASSET_BYTES = 16 * 1024 * 1024
MAX_ALL_BYTES = 32 * 1024 * 1024
MAX_FILES = 200
_REFUSED = {
    "extension": "plugins run code that MART does not have",
    "plugin": "plugins run code that MART does not have",
    "model": "write its bodies into the file, or use <include>",
}
_FOLDERS = {
    "mesh": "meshdir",
    "skin": "meshdir",
    "flexcomp": "meshdir",
    "texture": "texturedir",
    "hfield": "assetdir",
}


@dataclass
class _Read:
    """Gather what a scene is made of: names as MuJoCo looks for them, and bytes."""

    path: Path
    folder: Path
    included: dict[str, str] = field(default_factory=dict)
    assets: dict[str, bytes] = field(default_factory=dict)
    angle: str | None = None
    all_bytes: int = 0


@dataclass(frozen=True)
class SceneSpec:
    """Hold a scene as it was read. says_angle: whether the file says in which unit its angles are."""

    spec: mujoco.MjSpec
    says_angle: bool


def read_scene(path: Path) -> SceneSpec:
    """Read an MJCF file. Raises NotFound and InvalidInput with what is missing or cannot be."""
    if not path.is_file():
        raise NotFound(f"There is no {path}; the task file names it under [scene] mjcf.")
    read = _Read(path, path.resolve().parent)
    text = _text(read, path)
    roots = [_root(path, text)]
    roots += _include(read, roots[0], depth=0)
    compiler = {key: value for root in roots for one in root.iter("compiler") for key, value in one.items()}
    for root in roots:
        for element in root.iter():
            _take(read, element, compiler)
    try:
        spec = mujoco.MjSpec.from_string(text, include=_bytes(read.included), assets=read.assets)
    except ValueError as error:
        raise InvalidInput(f"{path} cannot be loaded: {' '.join(str(error).split())}.") from error
    spec.assets = dict(read.assets)
    spec.modelfiledir = ""
    return SceneSpec(spec, says_angle="angle" in compiler)


def _bytes(included: dict[str, str]) -> dict[str, bytes]:
    return {name: text.encode() for name, text in included.items()}


def _text(read: _Read, path: Path) -> str:
    size = path.stat().st_size
    if size > MAX_XML_BYTES:
        raise InvalidInput(
            f"{path} has {size} bytes; an MJCF file may have {MAX_XML_BYTES}: put meshes into files."
        )
    _count(read, size)
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{path} is not text (UTF-8).") from error
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InvalidInput(f"{path} declares a document type; leave <!DOCTYPE …> out, an MJCF needs none.")
    return text


def _root(path: Path, text: str) -> ET.Element:
    try:
        return ET.fromstring(text)  # noqa: S314 - bounded, and without entities
    except ET.ParseError as error:
        raise InvalidInput(f"{path} is not XML: {error}.") from error


def _include(read: _Read, root: ET.Element, depth: int) -> Iterator[ET.Element]:
    """Yield the roots of all files that are included, and keep their text."""
    for element in root.iter("include"):
        name = element.get("file", "")
        if depth >= 8 or name in read.included:
            raise InvalidInput(f"{read.path} includes {name!r} again or too deeply; include each file once.")
        path = _inside(read, name, "include")
        read.included[name] = _text(read, path)
        found = _root(path, read.included[name])
        yield found
        yield from _include(read, found, depth + 1)


def _take(read: _Read, element: ET.Element, compiler: dict[str, str]) -> None:
    if element.tag in _REFUSED and (element.tag != "model" or element.get("file")):
        raise InvalidInput(f"{read.path} has <{element.tag}>, which is not taken: {_REFUSED[element.tag]}.")
    if element.tag == "include":
        return
    names = [value for key, value in element.items() if key == "file" or key.startswith("file")]
    for name in filter(None, names):
        folder = compiler.get(_FOLDERS.get(element.tag, ""), compiler.get("assetdir", ""))
        if _is_outside(folder):
            raise InvalidInput(
                f"{read.path} says {folder!r} for a folder; it has to be below the file's own."
            )
        path = _inside(read, str(Path(folder) / name), element.tag)
        size = path.stat().st_size
        if size > MAX_ASSET_BYTES:
            raise InvalidInput(
                f"{name} of {read.path} has {size / 1e6:.0f} MB; {MAX_ASSET_BYTES // 1_000_000} are allowed: "
                "make it coarser. Everybody who looks at the room is sent it."
            )
        _count(read, size)
        read.assets[str(Path(folder) / name)] = path.read_bytes()
        read.assets[name] = read.assets[str(Path(folder) / name)]


def _count(read: _Read, size: int) -> None:
    read.all_bytes += size
    if read.all_bytes > MAX_ALL_BYTES or len(read.assets) + len(read.included) > 2 * MAX_FILES:
        raise InvalidInput(
            f"{read.path} needs more than {MAX_FILES} files or {MAX_ALL_BYTES // 1_000_000} MB; make meshes coarser."
        )


def _inside(read: _Read, name: str, tag: str) -> Path:
    """Return where a file lies. Raises InvalidInput outside the MJCF's folder, NotFound where there is none."""
    path = (read.folder / name).resolve()
    if _is_outside(name) or not path.is_relative_to(read.folder):
        raise InvalidInput(
            f"{read.path} names {name!r} in <{tag}>, outside its own folder; put the file beside it or below."
        )
    if not path.is_file():
        raise NotFound(f"There is no {name}, which {read.path} names in <{tag}>; it should be at {path}.")
    return path


def _is_outside(name: str) -> bool:
    return Path(name).is_absolute() or ".." in Path(name.replace("\\", "/")).parts
