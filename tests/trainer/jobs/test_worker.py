"""The process of a job: how it ends, and that a kill in the middle of a checkpoint tears none."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from mart.protocol import clock
from mart.runtime.ports import free_port
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.jobs.job import ExitCode, JobSpec
from mart.trainer.jobs.job_files import save_spec, why_ended
from mart.trainer.jobs.worker import run_job
from mart.trainer.models.policies.load import load_policy
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from tests.trainer.conftest import Recorded
from tests.trainer.recorded import TASK

pytestmark = [pytest.mark.system, pytest.mark.timeout(300)]
_WAIT_S = 120.0


def order(episodes: Recorded, run: Path, evaluation: EvaluationSpec, **changes: int) -> None:
    training = TrainingSpec(model="BC", data=(episodes.root,), preset="debug", changes=changes)
    save_spec(run, JobSpec(training=training, evaluation=evaluation))


def test_without_worlds_it_trains_to_the_end_and_asks_to_be_tried_again(
    episodes: Recorded, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MART_ROUTER", f"tcp/127.0.0.1:{free_port()}")
    order(episodes, tmp_path, EvaluationSpec(task=TASK, replicas=("replica-9",)))
    assert run_job(tmp_path, threading.Event()) is ExitCode.AWAY
    assert "Could not reach a router" in why_ended(tmp_path, ExitCode.AWAY)
    assert RunDirectory(tmp_path).checkpointed() == (10, 20)


def test_asked_to_stop_it_stops(episodes: Recorded, tmp_path: Path) -> None:
    order(episodes, tmp_path, EvaluationSpec(task=TASK, episodes=0))
    stop = threading.Event()
    stop.set()
    assert run_job(tmp_path, stop) is ExitCode.STOPPED


def test_what_cannot_be_trained_is_refused(episodes: Recorded, tmp_path: Path) -> None:
    order(episodes, tmp_path, EvaluationSpec(task=TASK), batch_size=0)
    assert run_job(tmp_path, threading.Event()) is ExitCode.REFUSED
    assert "batch_size" in why_ended(tmp_path, ExitCode.REFUSED)
    (tmp_path / "job.json").write_text("{}")
    assert run_job(tmp_path, threading.Event()) is ExitCode.REFUSED
    assert "cannot be read" in why_ended(tmp_path, ExitCode.REFUSED)


def test_an_end_is_put_into_words(tmp_path: Path) -> None:
    assert why_ended(tmp_path, -9) == "its process was killed (SIGKILL)"
    assert "exit status 2" in why_ended(tmp_path, 2)


def test_a_kill_in_the_middle_of_a_checkpoint_tears_none(episodes: Recorded, tmp_path: Path) -> None:
    order(episodes, tmp_path, EvaluationSpec(task=TASK, episodes=0), checkpoints=20)
    run = RunDirectory(tmp_path)
    with subprocess.Popen([sys.executable, "-m", "mart.trainer.jobs.worker", str(tmp_path)]) as process:
        half = _wait_for_half(run, process)
        process.kill()
    assert process.returncode == -9, f"{half} was seen too late"
    survived = run.checkpointed()
    assert 0 < len(survived) < 20
    for updates in survived:
        for seed in run.seeds(updates):
            load_policy(run.checkpoint(updates, seed))
    assert run_job(tmp_path, threading.Event()) is ExitCode.DONE
    assert len(run.checkpointed()) == 20
    assert not list(tmp_path.rglob("*.half"))


def _wait_for_half(run: RunDirectory, process: subprocess.Popen[bytes]) -> Path:
    """A checkpoint that is being written now, after some that are whole."""
    deadline_s = clock.monotonic_s() + _WAIT_S
    while clock.monotonic_s() < deadline_s and process.poll() is None:
        if len(run.checkpointed()) > 1 and (found := list(run.checkpoints.glob("*.half"))):
            return found[0]
    raise AssertionError(f"no checkpoint was caught; the process ended with {process.poll()}")
