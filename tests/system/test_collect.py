"""`mart collect --lockstep` with every real part: rooms, recorder, replica, router, each a process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from mart.episodes.reader import EpisodeFile
from mart.protocol import recording

_MART = Path(sys.executable).with_name("mart")
_LIMIT_S = 240.0
_EPISODES = 4  # of this seed, three succeed


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("collected")


@pytest.fixture(scope="module")
def collected(out: Path) -> dict[str, Any]:
    options = ["--episodes", str(_EPISODES), "--skill", "novice", "--seed", "0", "--lockstep", "--json"]
    return mart("collect", *options, "--out", str(out))


def mart(*command: str) -> dict[str, Any]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MART_")}
    ended = subprocess.run(
        [str(_MART), *command], capture_output=True, text=True, timeout=_LIMIT_S, env=environment, check=False
    )
    assert ended.returncode == 0, ended.stderr
    *lines, last = map(json.loads, ended.stdout.splitlines())
    found: dict[str, Any] = {"episodes": lines, **last}
    return found


def test_successes_and_failures_are_saved_and_verified_alike(collected: dict[str, Any]) -> None:
    episodes = collected["episodes"]
    assert len(episodes) == collected["count"] == collected["verified"] == _EPISODES
    assert {episode["outcome"] for episode in episodes} == {"success", "failure"}
    assert collected["failures"] == {"time is up": _EPISODES - collected["successes"]}
    assert {episode["skill"] for episode in episodes} == {"novice"}
    assert len({episode["seed"] for episode in episodes}) == _EPISODES


def test_the_files_are_like_live_ones_and_say_how_they_were_made(collected: dict[str, Any]) -> None:
    for told in collected["episodes"]:
        file = EpisodeFile.open(Path(told["path"]))
        episode = file.episode
        assert (episode.mode, episode.skill, episode.time_limit_s) == ("lockstep", "novice", 10.5)
        assert (episode.seed, episode.ticks, episode.outcome) == (
            told["seed"],
            told["ticks"],
            told["outcome"],
        )
        assert episode.complete
        assert not episode.interrupted
        assert file.cadence.missing_ticks == file.cadence.messages_lost == 0
        assert {arm: str(shifts[0]) for arm, shifts in file.operators.shifts.items()} == {
            "arm0": "script",
            "arm1": "script",
        }
        counts = dict.fromkeys((recording.STATE, "/arm/arm0/command", "/arm/arm1/command"), 0)
        for message in file.messages(*counts):
            counts[message.topic] += 1
        assert counts[recording.STATE] == episode.ticks + 1
        assert counts["/arm/arm0/command"] >= episode.ticks
        assert len(file.model()) > 100_000


def test_the_list_tells_what_a_table_needs(collected: dict[str, Any], out: Path) -> None:
    rows = mart("episodes", "list", "--json", str(out))["episodes"]
    keys = ("outcome", "reason", "skill", "seed", "ticks", "simulated_s", "verified")
    found = {row["path"]: {key: row[key] for key in keys} for row in rows}
    assert found == {
        episode["path"]: {key: episode[key] for key in keys} for episode in collected["episodes"]
    }
    assert {row["mode"] for row in rows} == {"lockstep"}
