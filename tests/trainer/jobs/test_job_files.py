"""What a job's files hold: names in them outlast names in the code."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from mart.protocol.errors import Corrupt
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.jobs.job import Job, JobSpec, JobState
from mart.trainer.jobs.job_files import load_spec, save_spec, say_why, why_ended
from mart.trainer.jobs.table import JobTable
from mart.trainer.train.spec import TrainingSpec

SPEC = JobSpec(
    training=TrainingSpec(model="HBC", data=(Path("/episodes"),), seeds=(0, 1), weights={"human": 2.0}),
    evaluation=EvaluationSpec(task="two_arm_multi_cube_lifting", episodes=5, replicas=("replica-1",)),
)
REQUEST = {
    "model": "HBC",
    "data": ["/episodes"],
    "dataset": None,
    "seeds": [0, 1],
    "preset": "fast",
    "changes": {},
    "selection": {
        "outcomes": ["success"],
        "verdicts": ["verified", "real"],
        "operators": [],
        "names": [],
        "first": None,
        "last": None,
        "skip_idle_s": None,
    },
    "weights": {"human": 2.0},
    "base": None,
    "device": "cpu",
    "held_out": 0.0,
    "control_hz": None,
}
JUDGING = {
    "task": "two_arm_multi_cube_lifting",
    "episodes": 5,
    "score_episodes": 100,
    "replicas": ["replica-1"],
}


def test_a_spec_is_kept_under_its_old_names(tmp_path: Path) -> None:
    save_spec(tmp_path, SPEC)
    assert json.loads((tmp_path / "job.json").read_text()) == {"request": REQUEST, "judging": JUDGING}
    assert load_spec(tmp_path) == SPEC


def test_a_spec_of_a_version_without_rates_learns_at_its_episodes_own(tmp_path: Path) -> None:
    request = {name: value for name, value in REQUEST.items() if name != "control_hz"}
    (tmp_path / "job.json").write_text(json.dumps({"request": request, "judging": JUDGING}))
    assert load_spec(tmp_path) == SPEC


def test_why_an_attempt_ended_is_told_until_the_next_one(tmp_path: Path) -> None:
    save_spec(tmp_path, SPEC)
    say_why(tmp_path, "The disk is full.")
    assert why_ended(tmp_path, 1) == "The disk is full."
    assert "SIGKILL" in why_ended(tmp_path, -9)
    assert "signal 40" in why_ended(tmp_path, -40)
    save_spec(tmp_path, SPEC)
    assert "exit status 1" in why_ended(tmp_path, 1)


def test_a_damaged_spec_is_refused(tmp_path: Path) -> None:
    with pytest.raises(Corrupt):
        load_spec(tmp_path)
    (tmp_path / "job.json").write_text('{"request": {}}')
    with pytest.raises(Corrupt):
        load_spec(tmp_path)


def test_the_table_keeps_jobs_under_its_old_names(tmp_path: Path) -> None:
    path = tmp_path / "jobs.sqlite"
    job = Job(7, 3, SPEC, "local", "runs/sweep-0003/job-0007", JobState.DONE, attempt=1, submitted_ns=5)
    with closing(JobTable(path)) as table:
        table.put([job])
        assert table.get(7) == job
    with closing(sqlite3.connect(path)) as connection:
        rows = connection.execute("SELECT number, sweep, request, judging, state, run FROM jobs").fetchall()
    ((number, sweep, request, judging, state, run),) = rows
    assert (number, sweep, state, run) == (7, 3, "done", job.run)
    assert (json.loads(request), json.loads(judging)) == (REQUEST, JUDGING)
