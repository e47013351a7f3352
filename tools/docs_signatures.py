"""Show in the API pages what pydantic's data classes are made from, as is shown of dataclasses: a griffe extension."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import griffe


class PydanticSignatures(griffe.Extension):
    """Give every class that derives from BaseModel directly the signature that pydantic gives it."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Griffe calls this when a package is loaded."""
        for model in _classes(pkg):
            if "BaseModel" in map(str, model.bases) and "__init__" not in model.members:
                model.set_member("__init__", _init_of(model))


def _classes(inside: griffe.Object) -> Iterator[griffe.Class]:
    for member in list(inside.members.values()):
        if isinstance(member, griffe.Class):
            yield member
        if isinstance(member, griffe.Module | griffe.Class):
            yield from _classes(member)


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
