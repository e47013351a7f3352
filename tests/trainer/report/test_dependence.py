"""Dependence between arms: found where it is, and not where it isn't."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task
from mart.trainer.models.policies.policy import Array, Policy
from mart.trainer.report import html
from mart.trainer.report.cli import report
from mart.trainer.report.coupling import read_couplings
from mart.trainer.report.dependence import BINS, MIN_EPISODES, ObservedEpisode, dependence
from tests.trainer.made_up_rollouts import write_footage

TASK = "two_arm_drink_tray_lifting"
OWN = np.array([0, 1])
WIDTH = 4


def episodes(number: int, coupled_from: float) -> list[ObservedEpisode]:
    """Two arms see two numbers each, which wander. arm0 follows its own; after `coupled_from`, arm1's."""
    random = np.random.default_rng(3)
    return [recorded(random, coupled_from) for _ in range(number)]


def recorded(random: np.random.Generator, coupled_from: float) -> ObservedEpisode:
    ticks = int(random.integers(60, 100))
    seen = np.cumsum(random.normal(size=(ticks, WIDTH)), axis=0) / 3
    alone = np.repeat(np.tanh(seen[:, :1]), 7, axis=1)
    together = np.repeat(np.tanh(seen[:, 2:3]), 7, axis=1)
    late = (np.arange(ticks) >= coupled_from * ticks)[:, None]
    first = np.where(late, together, alone) + random.normal(scale=0.05, size=(ticks, 7))
    return ObservedEpisode(seen, np.stack([first, random.normal(size=(ticks, 7))], axis=1))


def test_an_arm_that_works_for_itself_does_not_depend() -> None:
    found = dependence(episodes(40, coupled_from=1.0), OWN, arm=0)
    assert abs(found.overall) < 0.05


def test_it_depends_when_it_depends() -> None:
    found = dependence(episodes(40, coupled_from=0.5), OWN, arm=0)
    assert found.score[BINS // 2 + 1 :].min() > 0.4
    assert found.low[BINS // 2 + 1 :].min() > 0.2
    assert found.overall > 0.1
    early = found.score[: BINS // 2 - 1]
    assert np.abs(early).max() < found.score[BINS // 2 + 1 :].min()
    assert ((found.low <= found.score) & (found.score <= found.high)).mean() > 0.8


def test_noise_depends_on_nothing() -> None:
    assert abs(dependence(episodes(40, coupled_from=0.0), np.array([2, 3]), arm=1).overall) < 0.1


def test_it_is_the_same_twice() -> None:
    first, second = (dependence(episodes(10, 0.5), OWN, arm=0) for _ in range(2))
    assert np.array_equal(first.score, second.score)


def test_too_few_episodes_are_said() -> None:
    with pytest.raises(InvalidInput):
        dependence(episodes(MIN_EPISODES - 1, 0.5), OWN, arm=0)


class Copies(Policy):
    """A joint policy: every arm's action is what arm1 sees of its own gripper."""

    task = TASK
    control_hz = 20.0
    arms = ("arm0", "arm1")
    arm_kinds = ()
    needs = ("arm1/gripper",)

    def begin(self, worlds: int, seed: int) -> None:
        """Remembers nothing."""

    def act(self, observations: Mapping[str, Array]) -> Array:
        return np.repeat(observations["arm1/gripper"][:, None], 7, axis=2) * np.ones((1, 2, 1))

    def only(self, arm: str) -> Copies:
        raise InvalidInput(f"{arm} is driven together with the others.")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for number in range(MIN_EPISODES):
        write_footage(tmp_path, number, TASK, ["lift_tray"], "success")
    return tmp_path


def test_what_a_model_relies_on_stands_beside(folder: Path) -> None:
    (coupling,) = read_couplings(folder, [Copies()])
    used = {arm.name: shares for arm, shares in coupling.reliance.items()}
    assert coupling.episodes == MIN_EPISODES
    assert coupling.reached == [("lift_tray", 0.5, True)]
    assert max(used["arm1"]) == 0.0  # its own part stays
    assert max(used["arm0"]) == pytest.approx(1.0)  # nothing else is used
    page = html.dependence_page([coupling], "Copies")
    assert page.count("<svg") == 1
    assert "what it uses, needed or not" in page


def test_the_command_writes_a_page(folder: Path, tmp_path: Path) -> None:
    words = ["dependence", str(folder), "--html", str(tmp_path / "page.html"), "--json"]
    found = json.loads(CliRunner().invoke(report, words, catch_exceptions=False).output)["tasks"]
    assert [task["task"] for task in found] == [TASK]
    assert set(found[0]["arms"]) == set(get_task(TASK).arm_names)
    assert "Drink tray lifting" in (tmp_path / "page.html").read_text()


def test_a_folder_without_successes_is_said(tmp_path: Path) -> None:
    write_footage(tmp_path, 0, TASK, [], "failure")
    with pytest.raises(NotFound):
        read_couplings(tmp_path)


def test_a_task_with_too_few_successes_is_named_before_any_other_is_worked_on(folder: Path) -> None:
    write_footage(folder, MIN_EPISODES, "two_arm_table_assembly", [], "success")
    with pytest.raises(InvalidInput, match=r"1 successful episodes of two_arm_table_assembly .* at least"):
        read_couplings(folder)
