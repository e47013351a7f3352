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
    with subprocess.Popen(
        [str(_MART), *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as collecting:
        assert collecting.stdout is not None
        first = collecting.stdout.readline()
        kill_service_of(tmp_path, "router")
        rest, complaint = collecting.communicate()
    assert collecting.returncode == 0, complaint
    *lines, summary = map(json.loads, [first, *rest.splitlines()])
    assert len({line["path"] for line in lines}) == len(lines) == summary["count"] == _EPISODES
    assert all(Path(line["path"]).is_file() for line in lines)
