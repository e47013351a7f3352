"""One metadata record of an episode file: typed fields to strings and back, each number bounded where it is read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, ValidationInfo, model_validator

from mart.protocol.errors import Corrupt


def _within(low: float, high: float) -> AfterValidator:
    """Bound a number where it is read from a file; what is written is what was measured."""

    def check(value: float, info: ValidationInfo) -> float:
        if info.context is not None and not low <= value <= high:
            raise ValueError(f"it must be from {low:g} to {high:g}")
        return value

    return AfterValidator(check)


# What a number of a record may be: what the messages and databases that carry it on can hold.
Count = Annotated[int, _within(0, 2**32 - 1)]
Tick = Annotated[int, _within(0, 2**63 - 1)]
UnixNs = Annotated[int, _within(0, 2**63 - 1)]
Seed = Annotated[int, _within(0, 2**64 - 1)]
Number = Annotated[float, _within(-1e15, 1e15)]
ControlHz = Annotated[float, _within(1e-3, 1e5)]

_MAX_TEXT_CHARACTERS = 4096
_FROM_FILE: Mapping[str, object] = {}  # that there is a context is all that is asked


class Record(BaseModel):
    """One metadata record: each field is one string in the file."""

    model_config = ConfigDict(frozen=True, allow_inf_nan=False)

    NAME: ClassVar[str]
    _MAPS: ClassVar[
        Mapping[str, str]
    ] = {}  # fields that are maps → the key of an entry, {} for what it is of

    def to_strings(self) -> dict[str, str]:
        plain = {n: _text(value) for n, value in self if self._says(n, value) and n not in self._MAPS}
        for name, key in self._MAPS.items():
            plain |= {key.format(of): _text(value) for of, value in getattr(self, name).items()}
        return plain

    @classmethod
    def _says(cls, name: str, value: object) -> bool:
        """Whether a value is written; no names are as good as an absent field that says so."""
        return value is not None and not (value == () == cls.model_fields[name].default)

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, values: dict[str, Any]) -> dict[str, Any]:
        gathered = {name: _matching(key, values) for name, key in cls._MAPS.items()}
        return values | {name: found for name, found in gathered.items() if found}

    @classmethod
    def from_strings(cls, strings: Mapping[str, str]) -> Self:
        for name, text in strings.items():
            if len(text) > _MAX_TEXT_CHARACTERS:
                raise Corrupt(
                    f"The record {cls.NAME} cannot be read: {name[:64]} has {len(text)} characters, more than "
                    f"{_MAX_TEXT_CHARACTERS}."
                )
        try:
            return cls.model_validate(dict(strings), context=_FROM_FILE)
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"])) or "a value"
            raise Corrupt(f"The record {cls.NAME} cannot be read: {where}: {first['msg']}.") from error


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return ",".join(value) if isinstance(value, tuple) else str(value)


def _matching(key: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values whose names fit `key`, by what stands at its {}."""
    before, after = key.split("{}")
    matches = {name: re.fullmatch(f"{before}(.+){after}", name) for name in values}
    return {match[1]: values[name] for name, match in matches.items() if match}
