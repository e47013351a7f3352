"""The texts that requests may hold: bounded, and without control characters, which no page of this site sends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from pydantic import AfterValidator, StringConstraints, ValidationInfo

from mart.protocol.plain_text import require_path, require_plain


def _named(check: Callable[[str, str], str]) -> Callable[[str, ValidationInfo], str]:
    return lambda given, info: check(info.field_name or "text", given)


FilePath = Annotated[str, StringConstraints(max_length=1024), AfterValidator(_named(require_path))]
Word = Annotated[str, StringConstraints(max_length=128), AfterValidator(_named(require_plain))]
Name = Annotated[str, StringConstraints(max_length=64), AfterValidator(_named(require_plain))]
