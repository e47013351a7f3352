"""A router admits who knows its secret, and nobody else; whoever is refused is told why, and soon."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.protocol import clock
from mart.protocol.errors import Forbidden, Unavailable
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.bus_secret import known_secrets
from mart.runtime.ports import free_port
from mart.runtime.router import admitting_router
from mart.runtime.router_notes import noted

pytestmark = pytest.mark.system  # real peers

_SOON_S = 15.0  # 3 s on a quiet machine


@pytest.fixture
def guarded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A router whose secret is in `tmp_path`; this process's data folder is another, and its notes are nobody's."""
    monkeypatch.setenv("MART_DATA_DIR", str(tmp_path / "mine"))
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with admitting_router(endpoint, tmp_path / "theirs" / "secrets" / "bus"):
        yield endpoint


def test_its_users_programs_find_the_secret_by_the_address(guarded: str) -> None:
    with ZenohBus.connect(guarded, wait_for_router=False) as bus:
        assert bus.alive("mart/@live/*/*") == []


def test_another_user_is_told_that_there_is_no_secret(
    guarded: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "another-users"))
    for waits in (False, True):
        began_s = clock.monotonic_s()
        with pytest.raises(Forbidden, match=r"there is none in .*MART_DATA_DIR"):
            ZenohBus.connect(guarded, wait_for_router=waits)
        assert clock.monotonic_s() - began_s < _SOON_S


def test_another_platforms_secret_is_told_from_none(
    guarded: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "another-users"))
    other = tmp_path / "mine" / "secrets" / "bus"
    other.parent.mkdir(parents=True)
    other.write_text("0" * 64)
    other.chmod(0o600)
    with pytest.raises(Forbidden, match="is another platform's"):
        ZenohBus.connect(guarded, wait_for_router=False)


def test_a_file_that_the_environment_names_is_enough(
    guarded: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "another-users"))
    monkeypatch.setenv("MART_BUS_SECRET_FILE", str(tmp_path / "theirs" / "secrets" / "bus"))
    ZenohBus.connect(guarded, wait_for_router=False).close()


def test_where_nobody_listens_it_is_not_the_secret() -> None:
    with pytest.raises(Unavailable):
        ZenohBus.connect(f"tcp/127.0.0.1:{free_port()}", wait_for_router=False)


def test_a_router_without_a_secret_admits_everybody(tmp_path: Path) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with ZenohBus.route(endpoint), noted(endpoint, b"0" * 64):
        ZenohBus.connect(endpoint, wait_for_router=False).close()


def test_a_note_is_gone_with_its_router() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with noted(endpoint, b"0" * 64):
        assert b"0" * 64 in known_secrets(endpoint).values()
    assert b"0" * 64 not in known_secrets(endpoint).values()
