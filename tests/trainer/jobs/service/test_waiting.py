"""`mart jobs wait` while router or trainer are started anew."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import pytest
from click.testing import CliRunner

from mart.protocol.errors import Unavailable
from mart.protocol.messages import JOB_STATE_DONE, JOB_STATE_RUNNING, Job, TrainerReply, TrainerRequest
from mart.trainer.jobs.service import cli

RUNNING = TrainerReply(jobs=[Job(id="job-0001", state=JOB_STATE_RUNNING)])
DONE = TrainerReply(jobs=[Job(id="job-0001", state=JOB_STATE_DONE)])
AWAY = Unavailable("No trainer 'trainer-1' is up.")


def wait(monkeypatch: pytest.MonkeyPatch, answers: Iterator[TrainerReply | Unavailable]) -> object:
    def ask(_trainer: str, _request: TrainerRequest) -> TrainerReply:
        answer = next(answers)
        if isinstance(answer, Unavailable):
            raise answer
        return answer

    monkeypatch.setattr(cli, "_ask", ask)
    monkeypatch.setattr(cli, "_LOOK_EVERY_S", 0.0)
    ended = CliRunner().invoke(cli.wait, ["sweep-0001"])
    return ended.exception or ended.exit_code


def test_a_trainer_that_is_away_for_a_moment_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    assert wait(monkeypatch, iter([RUNNING, AWAY, AWAY, RUNNING, DONE])) == 0


def test_one_that_stays_away_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "_SILENCE_S", 0.0)
    assert wait(monkeypatch, itertools.chain([RUNNING], itertools.repeat(AWAY))) is AWAY


def test_one_that_was_never_there_is_told_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    assert wait(monkeypatch, iter([AWAY])) is AWAY
