"""Docstrings stand alone: in a tooltip, without the code around them, they say what they speak of."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.contract.repository import listed, parsed, place, sources

# A word with which something else is continued: a preposition, a conjunction, or what is said beside the main thing.
# fmt: off
_CONTINUING = {
    "about", "above", "across", "after", "against", "along", "among", "and", "around", "as", "at", "because",
    "before", "behind", "below", "beneath", "beside", "between", "beyond", "but", "by", "during", "for", "from",
    "if", "in", "inside", "into", "like", "near", "none", "nor", "of", "off", "on", "once", "onto", "or", "out",
    "outside", "over", "per", "raises", "since", "so", "than", "that", "through", "throughout", "to", "toward",
    "towards", "under", "unless", "until", "up", "upon", "when", "where", "whereas", "while", "with", "within",
    "without", "yet",
}
# fmt: on
_FEWEST_WORDS = 3

_Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def is_fragment(docstring: str, *, of_module: bool = False) -> bool:
    """Whether the beginning leaves open what is spoken of.

    It does where it continues something ("Of one seat.", "Raises NotFound."), is of one or two words, or begins with
    an argument's name, a shape or a number ("`seed`: …", "[M, B]") instead of a word with a capital letter. A module
    may begin with its command: "`mart run`: …". "Whether the seat is free." is none: it names what is returned.
    """
    words = docstring.split("\n\n", maxsplit=1)[0].split()
    first = words[0]
    return (
        first.strip(",.:;").lower() in _CONTINUING
        or len(words) < _FEWEST_WORDS
        or not (first[0].isupper() or (of_module and first[0] == "`"))
    )


@pytest.mark.parametrize(
    "docstring",
    [
        "Of one seat.",
        "As they travel.",
        "Raises NotFound where there is none.",
        "Measured.",
        "`seed`: of the episode.",
        "[M, B].",
    ],
)
def test_fragments_are_told(docstring: str) -> None:
    assert is_fragment(docstring)


@pytest.mark.parametrize(
    "docstring",
    [
        "Read one episode.",
        "Return the pose of the tool, shape (7,).",
        "Whether the seat is free.",
        "One room of the platform.",
    ],
)
def test_sentences_are_told(docstring: str) -> None:
    assert not is_fragment(docstring)


def test_no_docstring_begins_with_a_fragment() -> None:
    offences = [
        f"{place(path, node)} {docstring.splitlines()[0]}"
        for path in sources()
        for node in _public(parsed(path))
        if (docstring := ast.get_docstring(node))
        and is_fragment(docstring, of_module=isinstance(node, ast.Module))
    ]
    assert offences == [], listed(offences)


def _public(node: _Documented) -> Iterator[_Documented]:
    """Yield a module, its public classes and functions, and the public methods of these classes."""
    yield node
    if isinstance(node, ast.Module | ast.ClassDef):
        for child in node.body:
            if isinstance(child, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and _is_public(
                child.name
            ):
                yield from _public(child)


def _is_public(name: str) -> bool:
    return not name.startswith("_") or name == "__init__"
