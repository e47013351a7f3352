"""`mart …` in this process, on a folder of real episode files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mart.runtime.cli import main
from mart.runtime.ports import free_port
from tests.recorder.files import write_episode


class Mart:
    """Runs `mart …` in this process, with no router anywhere."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], data_dir: Path
    ) -> None:
        self._monkeypatch, self._capsys = monkeypatch, capsys
        self.episodes_dir = data_dir / "episodes"
        monkeypatch.setenv("MART_DATA_DIR", str(data_dir))
        monkeypatch.setenv("MART_ROUTER", f"tcp/127.0.0.1:{free_port()}")

    def __call__(self, *arguments: object, code: int = 0) -> str:
        """Standard output, or standard error where it fails."""
        self._monkeypatch.setattr("sys.argv", ["mart", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            main()
        printed = self._capsys.readouterr()
        assert stopped.value.code == code, printed
        return printed.err if code and not printed.out else printed.out

    def json(self, *arguments: object, code: int = 0) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self(*arguments, "--json", code=code))
        return found


@pytest.fixture
def mart(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Mart:
    return Mart(monkeypatch, capsys, tmp_path)


@pytest.fixture
def path(mart: Mart) -> Path:
    return write_episode(mart.episodes_dir).path
