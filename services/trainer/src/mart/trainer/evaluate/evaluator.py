"""Evaluate runs: every checkpoint in the shared worlds, and the best one of each seed anew in worlds of its own.

The paper keeps the best checkpoint's rate (section "Data Analysis"). The best of many noisy rates is too high: of ten
checkpoints that truly succeed half of the time, 30 episodes each, the best one shows 64 % on average. So the best is
scored once more, in worlds that had no part in choosing it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task
from mart.rollouts.client import RolloutClient
from mart.trainer.evaluate.config import EvalConfig
from mart.trainer.evaluate.evaluation import Evaluation, append_evaluations, best_evaluation, read_evaluations
from mart.trainer.evaluate.rollout_recorder import RolloutRecorder
from mart.trainer.evaluate.rollouts import RolloutResult, roll_out
from mart.trainer.evaluate.world_seeds import Purpose, world_seeds
from mart.trainer.models.checkpoint import CheckpointRecord, read_record
from mart.trainer.models.policies.load import load_policy
from mart.trainer.models.policies.policy import Policy
from mart.trainer.train.run_directory import RunDirectory

OnEvaluation = Callable[[Evaluation], None]


@dataclass(frozen=True)
class _EvaluatedPolicy:
    """What an evaluation says of a policy; seed and updates of its training, 0 of one that was trained elsewhere."""

    name: str
    task: str
    control_hz: float
    arms: tuple[str, ...]
    arm_kinds: tuple[str, ...]
    seed: int = 0
    updates: int = 0

    @classmethod
    def of(cls, record: CheckpointRecord) -> _EvaluatedPolicy:
        return cls(
            record.name,
            record.task,
            record.control_hz,
            record.arms,
            record.arm_kinds,
            record.seed,
            record.updates,
        )


@dataclass(frozen=True)
class Evaluator:
    """Evaluate checkpoints in worlds of one client. Raises what loading and rolling out raise.

    on_ticks: told how many ticks more are done with, as by `roll_out`.
    """

    client: RolloutClient
    config: EvalConfig
    device: str = "cpu"
    on_ticks: Callable[[int], None] = lambda _: None

    def evaluate_checkpoints(
        self, paths: Sequence[Path], purpose: Purpose, kept_in: Path | None = None
    ) -> list[Evaluation]:
        """Evaluate checkpoints of one task and rate together, all in the same worlds; return an evaluation for each.

        kept_in: the folder for episode files of failures; None keeps none.
        """
        config = self.config
        policies = [load_policy(path, self.device) for path in paths]
        seeds = world_seeds(purpose, config.world_seed, config.number(purpose))
        rollouts = roll_out(
            policies, self.client, seeds, config.world_seed, config.time_limit_s, on_ticks=self.on_ticks
        )
        return [
            self._evaluation(_EvaluatedPolicy.of(read_record(path)), path, purpose, own, kept_in)
            for path, own in zip(paths, rollouts, strict=True)
        ]

    def evaluate_policy(self, policy: Policy, path: Path) -> Evaluation:
        """Evaluate a policy that was trained elsewhere; return its evaluation, which names the folder `path`."""
        config, purpose = self.config, Purpose.SELECTION
        seeds = world_seeds(purpose, config.world_seed, config.number(purpose))
        (rollouts,) = roll_out(
            [policy], self.client, seeds, config.world_seed, config.time_limit_s, on_ticks=self.on_ticks
        )
        name = getattr(policy, "name", path.name)
        evaluated = _EvaluatedPolicy(name, policy.task, policy.control_hz, policy.arms, policy.arm_kinds)
        return self._evaluation(evaluated, path, purpose, rollouts, None)

    def evaluate_new(self, run: RunDirectory, on_evaluation: OnEvaluation) -> None:
        """Evaluate every checkpoint of the run that was not evaluated in these worlds yet, one's seeds together."""
        known = {(found.updates, found.seed) for found in self.known(run, Purpose.SELECTION)}
        for updates in run.checkpointed():
            seeds = [seed for seed in run.seeds(updates) if (updates, seed) not in known]
            paths = [run.checkpoint(updates, seed) for seed in seeds]
            self._evaluate_of_run(run, paths, Purpose.SELECTION, on_evaluation)

    def score_best(self, run: RunDirectory, on_evaluation: OnEvaluation) -> None:
        """Evaluate the best checkpoint of each seed in fresh worlds, where that has not been done yet."""
        if not self.config.score_episodes:
            return
        scored = {(found.updates, found.seed) for found in self.known(run, Purpose.SCORE)}
        of_seed: defaultdict[int, list[Evaluation]] = defaultdict(list)
        for found in self.known(run, Purpose.SELECTION):
            of_seed[found.seed].append(found)
        chosen = [best_evaluation(found) for _, found in sorted(of_seed.items())]
        paths = [run.checkpoint(b.updates, b.seed) for b in chosen if (b.updates, b.seed) not in scored]
        self._evaluate_of_run(run, paths, Purpose.SCORE, on_evaluation)

    def known(self, run: RunDirectory, purpose: Purpose) -> list[Evaluation]:
        """Return the run's evaluations with this config, of checkpoints that are still there."""
        config = self.config
        return [
            found
            for found in read_evaluations(run.evaluations)
            if found.purpose is purpose
            and (found.world_seed, len(found.played)) == (config.world_seed, config.number(purpose))
            and config.time_limit_s in (None, found.time_limit_s)
            and run.checkpoint(found.updates, found.seed).is_dir()
        ]

    def _evaluate_of_run(
        self, run: RunDirectory, paths: Sequence[Path], purpose: Purpose, on_evaluation: OnEvaluation
    ) -> None:
        if not paths:
            return
        made = self.evaluate_checkpoints(paths, purpose, run.path / "rollouts")
        made = [found.model_copy(update={"checkpoint": _below(run, found)}) for found in made]
        append_evaluations(run.evaluations, made)
        for found in made:
            on_evaluation(found)

    def _evaluation(
        self,
        record: _EvaluatedPolicy,
        path: Path,
        purpose: Purpose,
        rollouts: Sequence[RolloutResult],
        kept_in: Path | None,
    ) -> Evaluation:
        task = get_task(record.task, len(record.arms), record.arm_kinds)
        names: dict[int, str] = {}
        if kept_in is not None:
            most = self.config.kept if purpose is Purpose.SCORE else min(1, self.config.kept)
            failed = [i for i, own in enumerate(rollouts) if not own.result.succeeded][:most]
            names = {i: f"{purpose}-{record.updates}-seed-{record.seed}-{i}" for i in failed}
            recorder = RolloutRecorder(self.client, task, record.control_hz, record.name)
            recorder.keep({kept_in / f"{name}.mcap": rollouts[i] for i, name in names.items()})
        return Evaluation(
            at_ns=clock.wall_ns(),
            model=record.name,
            task=record.task,
            seed=record.seed,
            updates=record.updates,
            checkpoint=str(path),
            purpose=purpose,
            world_seed=self.config.world_seed,
            time_limit_s=self.config.time_limit_s or task.trial_limit_s,
            played=tuple(
                own.result.model_copy(update={"rollout": names.get(i, "")}) for i, own in enumerate(rollouts)
            ),
        )


def run_of(checkpoint: Path) -> RunDirectory | None:
    """Return the run that a checkpoint lies in, or None."""
    folder = checkpoint.resolve()
    for parent in folder.parents[:3]:
        run = RunDirectory(parent)
        if folder.is_relative_to(run.checkpoints) and (parent / "run.json").is_file():
            return run
    return None


def require_task(checkpoint: Path, task: str) -> None:
    """Raise InvalidInput where a checkpoint is of another task."""
    record = read_record(checkpoint)
    if record.task != task:
        raise InvalidInput(f"{checkpoint} was trained for {record.task}, not for {task}; give one that was.")


def _below(run: RunDirectory, evaluation: Evaluation) -> str:
    return run.checkpoint(evaluation.updates, evaluation.seed).relative_to(run.path).as_posix()
