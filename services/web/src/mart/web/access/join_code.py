"""The codes that let people in, let them watch or let them host: short enough to read out across a lab."""

from __future__ import annotations

import hmac
import secrets
from pathlib import Path

from mart.protocol.errors import Forbidden, InvalidInput
from mart.runtime.atomic_file import write_atomically

_ALPHABET = "23456789ABCDEFGHJKMNPQRSTVWXYZ"  # nothing that can be taken for something else
_GROUP = 4
_MIN_CHARACTERS = 6
_MIN_HOST_CHARACTERS = 12


def load_or_make_join_code(path: Path, fixed: str = "") -> str:
    """Return the code kept at `path`, or `fixed` where one is given; made at first use.

    Raises InvalidInput where it is too short.
    """
    kept = path.read_text().strip() if path.exists() else ""
    code = fixed.strip() or kept or _make(2)
    if len(_plain(code)) < _MIN_CHARACTERS:
        raise InvalidInput(
            f"A join code of {len(_plain(code))} letters and digits was given; at least {_MIN_CHARACTERS} are needed."
        )
    if code != kept:
        write_atomically(path, f"{code}\n".encode())
    return code


def load_or_make_host_code(path: Path) -> str:
    """Return the code kept at `path`, readable by its owner alone; made at first use, or where it is too short."""
    kept = path.read_text().strip() if path.exists() else ""
    if len(_plain(kept)) >= _MIN_HOST_CHARACTERS:
        return kept
    code = _make(3)
    write_atomically(path, f"{code}\n".encode())
    return code


def check_host_code(given: str, expected: str) -> None:
    """Compare what was given with the host code, as `check_join_code` does; raises Forbidden where they differ."""
    if not _is_same(given, expected):
        raise Forbidden(
            "This host code is not right; it is shown where `mart run` was started, and kept in the data folder "
            "(`host-code`)."
        )


def check_join_code(given: str, expected: str) -> None:
    """Compare what was given with the join code, or that for watching; case, spaces and dashes do not matter.

    Raises Forbidden where they differ, after equally long wherever the difference is.
    """
    if not _is_same(given, expected):
        raise Forbidden(
            "This join code is not right; ask the host for it, or look where `mart run` was started."
        )


def digest_of(code: str, secret: bytes) -> bytes:
    """Return what tells one join code from another, and tells nothing of it to whoever lacks the secret."""
    return hmac.digest(secret, _plain(code).encode(), "sha256")


def watch_code_of(code: str, secret: bytes) -> str:
    """Return the code that lets people watch where `code` lets them in; it tells nothing of `code`."""
    digest = hmac.digest(secret, b"watch " + _plain(code).encode(), "sha256")
    letters = [_ALPHABET[byte % len(_ALPHABET)] for byte in digest[: 3 * _GROUP]]
    return _grouped(letters)


def _make(groups: int) -> str:
    return _grouped([secrets.choice(_ALPHABET) for _ in range(groups * _GROUP)])


def _grouped(letters: list[str]) -> str:
    return "-".join("".join(letters[start : start + _GROUP]) for start in range(0, len(letters), _GROUP))


def _is_same(given: str, expected: str) -> bool:
    return hmac.compare_digest(_plain(given).encode(), _plain(expected).encode())


def _plain(code: str) -> str:
    return "".join(character for character in code.upper() if character.isalnum())
