from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.web.access.user_sessions import MAX_NAME_CHARACTERS, SESSION_S, UserSessions, clean_name


def test_a_restart_throws_nobody_out(tmp_path: Path) -> None:
    path = tmp_path / "web" / "sessions.sqlite"
    with contextlib.closing(UserSessions(path)) as people:
        session_id, ana = people.join("Ana", 0.0)
    with contextlib.closing(UserSessions(path)) as people:
        assert people.find(session_id, SESSION_S) == ana


def test_the_file_lets_nobody_in(tmp_path: Path) -> None:
    path = tmp_path / "sessions.sqlite"
    with contextlib.closing(UserSessions(path)) as people:
        session_id, _ = people.join("Ana", 0.0)
    assert path.stat().st_mode & 0o777 == 0o600
    assert not any(session_id.encode() in file.read_bytes() for file in tmp_path.iterdir())


def test_a_visit_ends_and_is_forgotten() -> None:
    people = UserSessions(":memory:")
    session_id, _ = people.join("Ana", 0.0)
    assert people.find(session_id, SESSION_S + 1) is None
    people.join("Ben", SESSION_S + 1)
    assert people._database.execute("SELECT count(*) FROM session").fetchone() == (1,)
    people.close()


def test_two_people_of_one_name_are_two_people() -> None:
    people = UserSessions(":memory:")
    assert people.join("Ana", 0.0)[1].holder_id != people.join("Ana", 0.0)[1].holder_id
    people.close()


@given(st.text())
def test_a_name_that_passes_is_one_printable_line(given_name: str) -> None:
    try:
        name = clean_name(given_name)
    except InvalidInput:
        return
    assert name.isprintable()
    assert name == name.strip()
    assert 1 <= len(name) <= MAX_NAME_CHARACTERS
    assert clean_name(name) == name


@pytest.mark.parametrize(("given_name", "name"), [("  Ana  María ", "Ana María"), ("李\n雷", "李 雷")])
def test_names_are_tidied(given_name: str, name: str) -> None:
    assert clean_name(given_name) == name
