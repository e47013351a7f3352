"""A router that is killed in the middle of a collection: words are lost, and no episode is."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.crashing import kill_service_of

_MART = Path(sys.executable).with_name("mart")
_EPISODES = 6


@pytest.mark.timeout(400)
def test_a_collection_outlasts_its_router(tmp_path: Path) -> None:
    """An episode that was under way may never reach the recorder; another one is made in its place."""
    command = ["collect", "--lockstep", "--episodes", str(_EPISODES), "--json", "--out", str(tmp_path)]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MART_")}
    complaint = tmp_path / "complaint"
    with (
        complaint.open("w") as complaints,
        subprocess.Popen(
            [str(_MART), *command], stdout=subprocess.PIPE, stderr=complaints, text=True, env=environment
        ) as collecting,
    ):
        assert collecting.stdout is not None
        printed: list[str] = []
        for line in collecting.stdout:  # not `communicate`, which would lose what came with the first line
            if not printed:
                kill_service_of(tmp_path, "router")
            printed.append(line)
    assert collecting.returncode == 0, complaint.read_text()
    *lines, summary = map(json.loads, printed)
    assert len({line["path"] for line in lines}) == len(lines) == summary["count"] == _EPISODES
    assert all(Path(line["path"]).is_file() for line in lines)
