"""Read the TOML files in which people describe what is theirs: arms, end effectors and tasks.

What a file describes is called as the file is; every mistake is a sentence that says where it is.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from mart.protocol.errors import InvalidInput, NotFound

SUFFIX = ".toml"
NAME_PATTERN = r"[a-z][a-z0-9_]{0,62}"
_NAME = re.compile(NAME_PATTERN)

_Model = TypeVar("_Model", bound=BaseModel)


@dataclass(frozen=True)
class FileSort:
    """Say what files of one sort are: what people call one, what lists them, which page describes them, their size.

    taken: keys that no file may say, because the reader sets them.
    """

    title: str
    listing: str
    page: str
    most_bytes: int
    taken: Collection[str] = ("name",)

    def read(self, path: Path) -> str:
        """Return a file's text. Raises NotFound where there is none, InvalidInput for what cannot be one."""
        if not path.is_file():
            raise NotFound(f"There is no {self.title} {path}; {self.listing}.")
        if not is_name(path.stem) or path.suffix != SUFFIX:
            raise InvalidInput(
                f"{path.name} cannot be the name of a file that is a {self.title}: use small letters, digits and "
                f"underscores, then {SUFFIX}."
            )
        self._require_small(path.stat().st_size, str(path))
        try:
            return path.read_text(encoding="utf-8")
        except UnicodeDecodeError as error:
            raise InvalidInput(f"{path} is not text (UTF-8).") from error

    def table(self, text: str, source: str) -> dict[str, Any]:
        """Return what a file's text says. source: what to call it. Raises InvalidInput for what is no TOML."""
        self._require_small(len(text), source)
        try:
            said: dict[str, Any] = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise InvalidInput(f"{source} is not TOML: {error}.") from error
        for key in self.taken:
            if key in said:
                raise InvalidInput(f"{source} says a {key}; it is called as its file is: leave the line out.")
        return said

    def checked(self, model: type[_Model], said: Mapping[str, Any], source: str) -> _Model:
        """Return what is said as `model` has it. Raises InvalidInput with the first mistake and its place."""
        try:
            return model.model_validate(said)
        except ValidationError as error:
            raise InvalidInput(f"{source} cannot be used: {self._sentence(error)}") from error

    def _require_small(self, size: int, source: str) -> None:
        if size > self.most_bytes:
            raise InvalidInput(
                f"{source} is larger than {self.most_bytes // 1024} KiB; a {self.title} holds text alone."
            )

    def _sentence(self, error: ValidationError) -> str:
        found = error.errors()
        # A key that is written wrongly is missing as well: which one it is says more.
        first = next((one for one in found if one["type"] == "extra_forbidden"), found[0])
        where = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in first["loc"])
        message = first["msg"].removeprefix("Value error, ").rstrip(".")
        if first["type"] == "extra_forbidden":
            message = f"there is no such key; leave it out, or look for its name in {self.page}"
        return f"{where.lstrip('.')}: {message}." if where else f"{message}."


def is_name(text: str) -> bool:
    """Return whether a file, and what it describes, can be called so."""
    return _NAME.fullmatch(text) is not None


def names_in(folder: Path) -> set[str]:
    """Return what the files of a folder describe, by name."""
    return {path.stem for path in folder.glob(f"*{SUFFIX}") if is_name(path.stem)}
