"""`mart train` as people type it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from mart.episodes import labels
from mart.protocol.errors import Conflict, InvalidInput, MartError
from mart.trainer.models.policies.load import load_policy
from mart.trainer.train.cli import train
from mart.trainer.train.run_directory import RunDirectory
from tests.trainer.conftest import Recorded


def mart_train(*words: object) -> Result:
    return CliRunner().invoke(train, [str(word) for word in words])


def test_it_trains_and_goes_on(episodes: Recorded, tmp_path: Path) -> None:
    run = tmp_path / "run"
    words = ("--model", "d-hbc", "--data", episodes.root, "--preset", "debug", "--out", run, "--json")
    first = mart_train(*words, "--seeds", 2, "--set", "updates=8", "--weight", "human=3")
    assert first.exit_code == 0, first.output
    result = json.loads(first.stdout)
    assert (result["model"], result["episodes"], result["seeds"]) == ("d-HBC", 3, [0, 1])
    assert result["times_seen"] == pytest.approx(
        8 * 8 * 10 / result["ticks"], abs=0.06
    )  # of debug's batch and window
    assert first.stderr == ""
    assert load_policy(Path(result["checkpoints"][-1])).record.updates == 8
    assert RunDirectory(run).spec.weights == {"human": 3.0}
    again = mart_train("--resume", run, "--json")
    assert again.exit_code == 0
    assert json.loads(again.stdout) == result


def test_without_json_it_tells_how_far_it_is(episodes: Recorded, tmp_path: Path) -> None:
    words = ("--model", "BC", "--data", episodes.root, "--preset", "debug", "--out", tmp_path / "run")
    told = mart_train(*words, "--set", "updates=2")
    assert told.exit_code == 0, told.output
    assert "base 2/2" in told.stderr


def test_its_selection_reaches_the_run(episodes: Recorded, tmp_path: Path) -> None:
    words = ("--model", "BC", "--data", episodes.root, "--preset", "debug", "--out", tmp_path / "run")
    chosen = mart_train(
        *words,
        "--outcome",
        "any",
        "--verdict",
        "verified",
        "--operator",
        "script",
        "--last",
        2,
        "--skip-idle",
        1,
    )
    assert chosen.exit_code == 0, chosen.output
    assert "from 2 episodes" in chosen.stdout
    selection = RunDirectory(tmp_path / "run").spec.selection
    assert selection.outcomes == ()
    assert selection.skip_idle_s == 1.0
    assert selection.operators == ("script",)


def test_it_takes_a_named_data_set_whole(episodes: Recorded, tmp_path: Path) -> None:
    root = tmp_path / "episodes"
    shutil.copytree(episodes.root, root)
    first, second, _ = sorted(root.rglob("*.mcap"))
    for path in (first, second):
        labels.say(path, labels.LabelKind.JOIN, "few", 1)
    labels.say(first, labels.LabelKind.USE, "drop", 2)
    words = (
        "--model",
        "BC",
        "--data",
        root,
        "--dataset",
        "few",
        "--preset",
        "debug",
        "--out",
        tmp_path / "run",
    )
    trained = mart_train(*words)
    assert trained.exit_code == 0, trained.output
    assert "from 1 episodes" in trained.stdout
    assert ", 1 of its 2 left out)" in trained.stdout
    dataset = RunDirectory(tmp_path / "run").spec.dataset
    assert dataset is not None
    assert f"of the data set few ({dataset.sha256[:12]}, " in trained.stdout
    labels.say(first, labels.LabelKind.USE, "keep", 3)
    changed = mart_train("--resume", tmp_path / "run").exception
    assert isinstance(changed, Conflict)
    assert "have changed since it was begun" in str(changed)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--model", "HBC"), "Give --out DIR for a new run"),
        (("--out", "x", "--model", "HBC"), "Give --model and --data or --dataset"),
        (("--out", "x", "--model", "HBC", "--data", ".", "--data", "..", "--dataset", "few"), "one folder"),
        (("--out", "x", "--model", "HBC", "--data", ".", "--set", "updates"), "write NAME=VALUE"),
        (("--out", "x", "--model", "HBC", "--data", ".", "--weight", "robot=2"), "see --help"),
    ],
)
def test_what_was_forgotten_is_said(words: tuple[str, ...], sentence: str) -> None:
    result = mart_train(*words)
    assert isinstance(result.exception, InvalidInput)
    assert sentence in str(result.exception)


def test_a_folder_that_is_no_run_is_said(tmp_path: Path) -> None:
    result = mart_train("--resume", tmp_path)
    assert isinstance(result.exception, MartError)
    assert "There is no run" in str(result.exception)


def test_a_run_that_could_not_begin_can_be_asked_anew(episodes: Recorded, tmp_path: Path) -> None:
    words = ("--model", "BC", "--data", episodes.root, "--preset", "debug", "--out", tmp_path / "run")
    assert isinstance(mart_train(*words, "--operator", "human").exception, InvalidInput)
    assert mart_train(*words, "--operator", "script").exit_code == 0
