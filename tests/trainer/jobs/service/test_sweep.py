"""What a submission becomes, without a trainer."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from unittest import mock

import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import Order, TrainerRequest
from mart.trainer.jobs.service import sweep
from mart.trainer.jobs.service.data_folders import episode_files
from mart.trainer.jobs.service.settings import TrainerSettings
from mart.trainer.jobs.service.sweep import job_specs

CUBES, TRAY = "two_arm_multi_cube_lifting", "two_arm_drink_tray_lifting"


@pytest.fixture
def settings(tmp_path: Path) -> TrainerSettings:
    day = tmp_path / "data" / "episodes" / "2026-11-22"
    day.mkdir(parents=True)
    for number, task in enumerate((CUBES, TRAY, TRAY)):
        (day / f"room-1-{number:04}-{task}.mcap").touch()
    return TrainerSettings(data_dir=tmp_path / "data")


def submission(*tasks: str, **order: Any) -> TrainerRequest.Submit:
    return TrainerRequest.Submit(models=["BC", "r-HBC"], tasks=tasks, order=Order(preset="debug", **order))


def test_a_folder_is_walked_once_for_all_models_and_tasks(settings: TrainerSettings) -> None:
    with mock.patch.object(sweep, "episode_files", wraps=episode_files) as walk:
        specs = job_specs(submission(CUBES, TRAY), settings)
    assert [(spec.evaluation.task, len(spec.training.data)) for spec in specs] == [
        (CUBES, 1),
        (CUBES, 1),
        (TRAY, 2),
        (TRAY, 2),
    ]
    assert walk.call_count == 1


def test_too_many_jobs_are_refused_before_any_folder_is_looked_at(settings: TrainerSettings) -> None:
    many = submission(CUBES, seeds=range(256))
    many.seeds_per_job = 1
    with mock.patch.object(sweep, "episode_files") as walk, pytest.raises(InvalidInput):
        job_specs(many, settings)
    assert walk.call_count == 0


@pytest.mark.parametrize("data", ["/", "/proc", "../other", "a\0b", "x" * 300])
@pytest.mark.parametrize("dataset", ["", "few"])
def test_nobody_looks_outside_the_data_folder(settings: TrainerSettings, data: str, dataset: str) -> None:
    with pytest.raises(InvalidInput):
        job_specs(submission(CUBES, data=data, dataset=dataset), settings)


def test_a_refusal_does_not_tell_where_the_data_folder_is(settings: TrainerSettings) -> None:
    with pytest.raises(NotFound) as refused:
        job_specs(submission(CUBES, data="nowhere"), settings)
    assert str(settings.data_dir) not in str(refused.value)


def test_idle_time_is_left_out_where_it_is_asked_for(settings: TrainerSettings) -> None:
    asked, usual = (job_specs(submission(CUBES, skip_idle_s=given), settings)[0] for given in (1.5, 0.0))
    assert asked.training.selection.skip_idle_s == 1.5
    assert usual.training.selection.skip_idle_s is None
    with pytest.raises(InvalidInput):
        job_specs(submission(CUBES, skip_idle_s=0.1), settings)
