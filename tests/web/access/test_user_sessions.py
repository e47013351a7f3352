from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput, Unavailable
from mart.web.access import user_sessions
from mart.web.access.user_sessions import MAX_NAME_CHARACTERS, SESSION_S, User, UserSessions, clean_name


def test_a_restart_throws_nobody_out(tmp_path: Path) -> None:
    path = tmp_path / "web" / "sessions.sqlite"
    with contextlib.closing(UserSessions(path)) as people:
        session_id, ana = people.join("Ana", 0.0)
    with contextlib.closing(UserSessions(path)) as people:
        assert people.find(session_id, SESSION_S) == ana


def test_who_has_passed_the_course_is_kept_over_a_restart_until_they_leave(tmp_path: Path) -> None:
    path = tmp_path / "sessions.sqlite"
    with contextlib.closing(UserSessions(path)) as people:
        session_id, ana = people.join("Ana", 0.0)
        people.join("Ben", 0.0)
        assert people.pass_course(lambda holder_id: holder_id == ana.holder_id, 40.0, 6)
        assert not people.pass_course(lambda _: False, 1.0, 1)
    with contextlib.closing(UserSessions(path)) as people:
        found = people.find(session_id, 1.0)
        assert found == User(ana.holder_id, "Ana", passed_course=True)
        assert people.has_passed_course(ana.holder_id)
        people.leave(found)
        assert not people.has_passed_course(ana.holder_id)


def test_the_best_time_of_a_course_is_kept() -> None:
    people = UserSessions(":memory:")
    people.join("Ana", 0.0)
    for seconds, tries in ((40.0, 6), (30.0, 5), (60.0, 4)):
        people.pass_course(lambda _: True, seconds, tries)
    assert people._database.execute("SELECT seconds, tries FROM passed_course").fetchall() == [(30.0, 5)]
    people.close()


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
    assert people._database.execute("SELECT count(*) FROM joined").fetchone() == (1,)
    people.close()


def test_two_people_of_one_name_are_two_people() -> None:
    people = UserSessions(":memory:")
    assert people.join("Ana", 0.0)[1].holder_id != people.join("Ana", 0.0)[1].holder_id
    people.close()


def test_another_join_code_ends_every_visit(tmp_path: Path) -> None:
    path = tmp_path / "sessions.sqlite"
    with contextlib.closing(UserSessions(path, b"old code")) as people:
        session_id, _ = people.join("Ana", 0.0)
    with contextlib.closing(UserSessions(path, b"new code")) as people:
        assert people.find(session_id, 0.0) is None
    with contextlib.closing(UserSessions(path, b"old code")) as people:
        assert people.find(session_id, 0.0) is None


def test_who_leaves_is_gone_and_nobody_else() -> None:
    people = UserSessions(":memory:")
    session_id, ana = people.join("Ana", 0.0)
    other_id, ben = people.join("Ben", 0.0)
    people.leave(ana)
    assert people.find(session_id, 0.0) is None
    assert people.find(other_id, 0.0) == ben
    people.close()


def test_a_person_has_one_visit_at_a_time() -> None:
    people = UserSessions(":memory:")
    first_id, ana = people.join("Ana", 0.0)
    second_id, again = people.join("Anna", 0.0, ana)
    assert again.holder_id == ana.holder_id
    assert people.find(first_id, 0.0) is None
    assert people.find(second_id, 0.0) == again
    people.close()


def test_visits_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(user_sessions, "MAX_SESSIONS", 3)
    people = UserSessions(":memory:")
    ids = [people.join(f"Ana {number}", float(number))[0] for number in range(5)]
    assert [people.find(session_id, 5.0) is not None for session_id in ids] == [
        False,
        False,
        True,
        True,
        True,
    ]
    people.close()


@pytest.mark.parametrize("content", [b"not a database at all, but long enough to look like one" * 40, b""])
def test_a_damaged_file_is_put_aside(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "sessions.sqlite"
    path.write_bytes(content)
    with contextlib.closing(UserSessions(path)) as people:
        session_id, ana = people.join("Ana", 0.0)
        assert people.find(session_id, 0.0) == ana
    assert path.with_suffix(".damaged").exists() == bool(content)


def test_a_full_disk_is_said_in_words() -> None:
    people = UserSessions(":memory:")
    people.close()
    with pytest.raises(Unavailable):
        people.find("any", 0.0)
    with pytest.raises(Unavailable):
        people.join("Ana", 0.0)


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


def test_who_hosts_does_so_until_the_host_code_is_another(tmp_path: Path) -> None:
    path = tmp_path / "sessions.sqlite"
    with contextlib.closing(UserSessions(path, b"join", b"host")) as sessions:
        session_id, ana = sessions.join("Ana", 0.0)
        assert sessions.host(ana).hosts
        guest_id, _ = sessions.join("Ben", 0.0)
        found = [sessions.find(one, 1.0) for one in (session_id, guest_id)]
        assert [one and one.hosts for one in found] == [True, False]
    with contextlib.closing(UserSessions(path, b"join", b"host")) as again:
        assert again.find(session_id, 1.0) == User(ana.holder_id, "Ana", hosts=True)
    with contextlib.closing(UserSessions(path, b"join", b"another")) as other:
        assert other.find(session_id, 1.0) == User(ana.holder_id, "Ana")
