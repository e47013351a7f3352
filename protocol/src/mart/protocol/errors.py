"""The error tree. A branch says what the caller can do about it.

MartError
├── InvalidInput   what was given cannot be used: change it
├── NotFound       no such thing: pick one that exists
├── Forbidden      not yours to do: get the right token or seat
├── Conflict       someone or something is in the way: wait or choose another
├── Unavailable    a part cannot be reached now: start it or try again
├── Corrupt        data does not hold together: repair it or leave it out
└── ServiceFault   a part failed at what it was asked: its log says why

Every error carries one sentence: what was given, what is allowed, what to do.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class MartError(Exception):
    """Root of everything that MART raises on purpose."""

    @property
    def code(self) -> str:
        """The branch's name, as sent on the wire."""
        return _branch_of(type(self)).__name__


class InvalidInput(MartError):
    """What was given cannot be used."""


class NotFound(MartError):
    """There is no such thing."""

    @classmethod
    def named(cls, kind: str, given: str, allowed: Iterable[str]) -> NotFound:
        """Make the error for an unknown name: `kind` in words ("task"), the name `given`, those that are `allowed`."""
        names = sorted(allowed)
        close = difflib.get_close_matches(given, names, n=1)
        hint = f" Did you mean {close[0]!r}?" if close else ""
        return cls(f"There is no {kind} {given!r}.{hint} Known: {', '.join(names) or 'none'}.")


class Forbidden(MartError):
    """The caller may not do this."""


class Conflict(MartError):
    """Someone or something is in the way."""


class Unavailable(MartError):
    """A part cannot be reached now."""


class Corrupt(MartError):
    """Data does not hold together."""


class ServiceFault(MartError):
    """A part failed at what it was asked, and goes on."""


BRANCHES: dict[str, type[MartError]] = {
    branch.__name__: branch
    for branch in (InvalidInput, NotFound, Forbidden, Conflict, Unavailable, Corrupt, ServiceFault)
}


def from_wire(code: str, message: str) -> MartError:
    """The error that another service reported; an unknown code becomes the root class."""
    return BRANCHES.get(code, MartError)(message)


def _branch_of(cls: type[MartError]) -> type[MartError]:
    for ancestor in cls.__mro__:
        if ancestor.__name__ in BRANCHES:
            return BRANCHES[ancestor.__name__]
    return MartError
