"""Griffe extension of the documentation site: examples and pydantic's data classes look as they should in API pages."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import griffe

_EXAMPLE = re.compile(r"^>>> .*(?:\n(?!\n).+)*", re.MULTILINE)  # with what follows it, to the next empty line
_FLAGS = re.compile(r" *# doctest: .*$", re.MULTILINE)


class SiteDocstrings(griffe.Extension):
    """Fence examples, and show pydantic's data classes with what they are made from."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Griffe calls this when a package is loaded."""
        for one in _objects(pkg):
            if one.docstring is not None:
                one.docstring.value = fenced(one.docstring.value)
            if isinstance(one, griffe.Class) and "BaseModel" in map(str, one.bases):
                one.members.setdefault("__init__", _init_of(one))


def fenced(docstring: str) -> str:
    """Put every example of a docstring, from `>>>` to an empty line, into a fence: Markdown takes it for a quote."""
    return _EXAMPLE.sub(lambda match: f"```pycon\n{_FLAGS.sub('', match[0])}\n```", docstring)


def _objects(inside: griffe.Object) -> Iterator[griffe.Object]:
    yield inside
    for member in list(inside.members.values()):
        if isinstance(member, griffe.Object):
            yield from _objects(member)


def _init_of(model: griffe.Class) -> griffe.Function:
    fields = (one for one in model.members.values() if isinstance(one, griffe.Attribute))
    parameters = [
        griffe.Parameter(
            field.name,
            annotation=field.annotation,
            kind=griffe.ParameterKind.keyword_only,
            default=_default_of(field.value),
        )
        for field in fields
        if field.annotation is not None and field.is_public and "property" not in field.labels
    ]
    own = griffe.Parameter("self", kind=griffe.ParameterKind.positional_or_keyword)
    return griffe.Function(
        "__init__",
        lineno=model.lineno,
        endlineno=model.endlineno,
        parameters=griffe.Parameters(own, *parameters),
        parent=model,
    )


def _default_of(value: str | griffe.Expr | None) -> str | griffe.Expr | None:
    """Return a field's default, also one inside of `Field(…)`; None where it has none."""
    if isinstance(value, griffe.ExprAttribute):
        return str(value)  # whole: the site would show the last word alone
    if not (isinstance(value, griffe.ExprCall) and str(value.function) == "Field"):
        return value
    named = {one.name: one.value for one in value.arguments if isinstance(one, griffe.ExprKeyword)}
    positional = [one for one in value.arguments if not isinstance(one, griffe.ExprKeyword)]
    if "default_factory" in named:
        return f"{named['default_factory']}()"
    return positional[0] if positional else named.get("default")
