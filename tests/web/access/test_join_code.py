from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.errors import Forbidden, InvalidInput
from mart.web.access.join_code import (
    check_host_code,
    check_join_code,
    load_or_make_host_code,
    load_or_make_join_code,
)


def test_a_code_is_made_once_and_kept_to_its_owner(tmp_path: Path) -> None:
    path = tmp_path / "data" / "join-code"
    code = load_or_make_join_code(path)
    assert load_or_make_join_code(path) == code == path.read_text().strip()
    assert path.stat().st_mode & 0o777 == 0o600
    assert len(code.replace("-", "")) == 8


def test_a_fixed_code_replaces_the_kept_one(tmp_path: Path) -> None:
    path = tmp_path / "join-code"
    load_or_make_join_code(path)
    assert load_or_make_join_code(path, "LAB-2026") == "LAB-2026" == path.read_text().strip()


def test_a_short_code_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput):
        load_or_make_join_code(tmp_path / "join-code", "AB-1")


@pytest.mark.parametrize("given", ["ABCD-2345", "abcd2345", " abcd 2345 "])
def test_how_it_is_typed_does_not_matter(given: str) -> None:
    check_join_code(given, "ABCD-2345")


@pytest.mark.parametrize("given", ["", "ABCD-2346", "ABCD-23455", "ÄBCD-2345", "💥" * 1000])
def test_anything_else_is_forbidden(given: str) -> None:
    with pytest.raises(Forbidden):
        check_join_code(given, "ABCD-2345")


def test_a_host_code_is_longer_and_kept_to_its_owner(tmp_path: Path) -> None:
    path = tmp_path / "data" / "host-code"
    code = load_or_make_host_code(path)
    assert load_or_make_host_code(path) == code == path.read_text().strip()
    assert path.stat().st_mode & 0o777 == 0o600
    assert len(code.replace("-", "")) == 12
    check_host_code(code.lower(), code)
    with pytest.raises(Forbidden, match="host code"):
        check_host_code("", code)


@pytest.mark.parametrize("spoilt", ["", "\n", "ABCD-2345\n"])
def test_a_host_code_that_is_none_is_made_anew(tmp_path: Path, spoilt: str) -> None:
    path = tmp_path / "host-code"
    path.write_text(spoilt)  # an empty one would let in whoever gives none
    assert len(load_or_make_host_code(path)) == 14
