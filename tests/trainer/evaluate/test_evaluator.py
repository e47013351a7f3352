"""Policies in worlds: a real replica over a real bus, policies that do what is known to succeed or nothing."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import InvalidInput, NotFound, Unavailable
from mart.protocol.messages import State
from mart.protocol.recording import STATE
from mart.protocol.tasks import get_task
from mart.render import PictureSpec, Renderer
from mart.rollouts.client import RolloutClient
from mart.rollouts.replicas import worlds
from mart.trainer.evaluate.cli import evaluate
from mart.trainer.evaluate.config import EvalConfig
from mart.trainer.evaluate.evaluation import Evaluation, read_evaluations
from mart.trainer.evaluate.evaluator import Evaluator, run_of
from mart.trainer.evaluate.rollout_recorder import RolloutRecorder
from mart.trainer.evaluate.rollouts import roll_out
from mart.trainer.evaluate.world_seeds import Purpose
from mart.trainer.models.policies.policy import Array
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.trainer.conftest import Recorded
from tests.trainer.recorded import TASK

pytestmark = pytest.mark.slow

SEEDS = (1, 2, 3)  # of the recorded episodes


@dataclass
class Scripted:
    """Does what is written, world by world; then nothing. actions: one [ticks, arms, 7] a world."""

    actions: Sequence[Array]
    arms: tuple[str, ...] = ("arm0", "arm1")
    arm_kinds: tuple[str, ...] = ()
    control_hz: float = 20.0
    task: str = TASK
    needs: tuple[str, ...] = ("arm0/gripper",)
    tick: int = 0

    def begin(self, worlds: int, seed: int) -> None:
        assert worlds == len(self.actions)
        self.tick = 0

    def act(self, observations: Mapping[str, Array]) -> Array:
        assert set(observations) == set(self.needs)
        now = [own[self.tick] if self.tick < len(own) else np.zeros((2, 7)) for own in self.actions]
        self.tick += 1
        return np.array(now)

    def only(self, arm: str) -> Scripted:
        raise InvalidInput(f"{arm} is driven together with the others.")


@dataclass
class Seeing(Scripted):
    """Keeps the pictures that it was shown."""

    pictures: Mapping[str, PictureSpec] = field(
        default_factory=lambda: {"ahead": PictureSpec("front", 48, 32)}
    )
    shown: list[NDArray[np.uint8]] = field(default_factory=list)

    def act(self, observations: Mapping[str, NDArray[Any]]) -> Array:
        self.shown.append(observations["ahead"])
        return super().act({name: observations[name] for name in self.needs})


@pytest.fixture(scope="module")
def client() -> Iterator[RolloutClient]:
    with worlds(()) as client:
        yield client


@pytest.fixture(scope="module")
def experts(episodes: Recorded) -> Scripted:
    """Succeeds in every world of SEEDS."""
    return Scripted([actions_of(states) for states in episodes.states])


def actions_of(states: Sequence[State]) -> Array:
    return np.array([[arm.action for arm in state.arms] for state in states[1:]])


def idle() -> Scripted:
    return Scripted([np.zeros((0, 2, 7))] * len(SEEDS))


def test_success_ends_an_episode_and_so_does_time(client: RolloutClient, experts: Scripted) -> None:
    won, lost = roll_out([experts, idle()], client, SEEDS, policy_seed=0, time_limit_s=7.0)
    assert [rollout.result.outcome for rollout in won] == ["success"] * 3
    assert [len(rollout.actions) for rollout in won] == [len(own) for own in experts.actions]
    assert [rollout.result.done for rollout in won] == [("lift_cube0", "lift_cube1")] * 3
    assert [rollout.result.seed for rollout in won] == list(SEEDS)
    assert {(rollout.result.outcome, rollout.result.time_s, rollout.result.done) for rollout in lost} == {
        ("time", 7.0, ())
    }


def test_a_policy_that_sees_is_shown_the_very_states_that_it_acts_on(
    client: RolloutClient, experts: Scripted, episodes: Recorded
) -> None:
    seeing = Seeing(experts.actions)
    idling, seen = roll_out([idle(), seeing], client, SEEDS, policy_seed=0)
    assert [rollout.result.outcome for rollout in seen] == ["success"] * 3
    assert not any(rollout.result.succeeded for rollout in idling)
    assert {pictures.shape for pictures in seeing.shown} == {(3, 32, 48, 3)}
    with closing(Renderer(episodes.world.model, "front", 48, 32)) as renderer:
        for world, states in enumerate(episodes.states):
            drawn = renderer.draw(states[10].integration_state).astype(int)
            assert np.abs(seeing.shown[10][world] - drawn).mean() < 0.5
    shortest = int(np.argmin([len(rollout.actions) for rollout in seen]))
    assert not seeing.shown[-1][shortest].any()  # it has ended: nobody looks there


def test_an_episode_is_the_same_alone_and_beside_others(client: RolloutClient, experts: Scripted) -> None:
    (alone,) = roll_out([experts], client, SEEDS, policy_seed=0, time_limit_s=2.0)
    _, beside = roll_out([idle(), experts], client, SEEDS, policy_seed=0, time_limit_s=2.0)
    for one, other in zip(alone, beside, strict=True):
        assert one.result == other.result
        assert np.array_equal(one.actions, other.actions)


def test_policies_that_do_not_fit_together_are_refused(client: RolloutClient) -> None:
    with pytest.raises(InvalidInput):
        roll_out([idle(), Scripted([], control_hz=60.0)], client, SEEDS, policy_seed=0)
    with pytest.raises(InvalidInput):
        roll_out([Scripted([], arms=("arm1", "arm0"))], client, SEEDS, policy_seed=0)


def test_a_kept_episode_shows_the_very_course(
    client: RolloutClient, experts: Scripted, episodes: Recorded, tmp_path: Path
) -> None:
    (rollouts,) = roll_out([experts], client, SEEDS, policy_seed=0)
    recorder = RolloutRecorder(client, get_task(TASK), 20.0, "the experts")
    recorder.keep({tmp_path / f"{seed}.mcap": rollout for seed, rollout in zip(SEEDS, rollouts, strict=True)})
    for seed, recorded in zip(SEEDS, episodes.states, strict=True):
        file = EpisodeFile.open(tmp_path / f"{seed}.mcap")
        states = [codec.decode(State, message.payload) for message in file.messages(STATE)]
        assert [s.integration_state for s in states] == [s.integration_state for s in recorded]
        assert (file.episode.seed, file.episode.outcome, file.episode.ticks) == (
            seed,
            "success",
            len(recorded) - 1,
        )
        assert states[-1].progress.success
        assert file.model() == episodes.world.model_bytes()
    recorder.keep({})


@pytest.fixture(scope="module")
def run(episodes: Recorded, tmp_path_factory: pytest.TempPathFactory) -> RunDirectory:
    folder = tmp_path_factory.mktemp("run")
    request = TrainingSpec(model="d-BC", data=(episodes.root,), seeds=(0, 5), preset="debug")
    train(request, folder, threading.Event(), lambda _: None)
    return RunDirectory(folder)


def test_a_run_is_judged_once(client: RolloutClient, run: RunDirectory) -> None:
    evaluator = Evaluator(client, EvalConfig(episodes=2, score_episodes=3, time_limit_s=1.0, kept=2))
    said: list[Evaluation] = []
    for _ in range(2):
        evaluator.evaluate_new(run, said.append)
        evaluator.score_best(run, said.append)
    assert said == read_evaluations(run.evaluations)
    assert [(e.purpose, e.updates, e.seed, len(e.played)) for e in said] == [
        *((Purpose.SELECTION, updates, seed, 2) for updates in (10, 20) for seed in (0, 5)),
        *((Purpose.SCORE, 20, seed, 3) for seed in (0, 5)),
    ]
    kept = {played.rollout for evaluation in said for played in evaluation.played if played.rollout}
    assert kept == {path.stem for path in (run.path / "rollouts").glob("*.mcap")}
    assert sum(played.rollout != "" for played in said[-1].played) == 2
    assert all((run.path / evaluation.checkpoint).is_dir() for evaluation in said)


def test_a_checkpoint_knows_its_run(run: RunDirectory, tmp_path: Path) -> None:
    assert run_of(run.checkpoint(20, 5)) == run
    assert run_of(tmp_path) is None


@pytest.mark.system
def test_the_command_judges_a_checkpoint_and_starts_its_own_worlds(run: RunDirectory) -> None:
    words = ["--checkpoint", str(run.checkpoint(20, 0)), "--episodes", "2", "--time-limit", "0.5", "--json"]
    found = json.loads(CliRunner().invoke(evaluate, words, catch_exceptions=False).output)["evaluations"]
    assert [(e["model"], e["success"], e["failures"]) for e in found] == [("d-BC", 0.0, {"lift_cube0": 2})]


def test_what_cannot_be_judged_is_said_in_a_sentence(run: RunDirectory, tmp_path: Path) -> None:
    checkpoint = str(run.checkpoint(20, 0))

    def say(*words: str) -> None:
        CliRunner().invoke(evaluate, words, catch_exceptions=False)

    with pytest.raises(NotFound):
        say("--checkpoint", str(tmp_path))
    with pytest.raises(InvalidInput):
        say("--checkpoint", checkpoint, "--task", "another")
    with pytest.raises(Unavailable):
        say("--checkpoint", checkpoint, "--replicas", "replica-9")
