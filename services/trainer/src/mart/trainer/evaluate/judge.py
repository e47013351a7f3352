"""Judges runs: every checkpoint in the shared worlds, and the best one of each seed anew in worlds of its own.

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
from mart.trainer.checkpoint import read_record
from mart.trainer.evaluate import result
from mart.trainer.evaluate.camera import Camera
from mart.trainer.evaluate.result import Evaluation
from mart.trainer.evaluate.rollouts import Course, play
from mart.trainer.evaluate.seeds import Purpose, world_seeds
from mart.trainer.policies import load_policy
from mart.trainer.runs import RunDirectory

Said = Callable[[Evaluation], None]


@dataclass(frozen=True)
class Rules:
    """How much is played.

    episodes: of each checkpoint. score_episodes: of the best one; 0: it is not scored. world_seed: decides the worlds.
    time_limit_s: of an episode; the length of the task's trials unless told. kept: failing episodes of a score that
    are written to `rollouts`; of a checkpoint's selection one is.
    """

    episodes: int = 30
    score_episodes: int = 100
    world_seed: int = 0
    time_limit_s: float | None = None
    kept: int = 4

    def number(self, purpose: Purpose) -> int:
        return self.episodes if purpose is Purpose.SELECTION else self.score_episodes


@dataclass(frozen=True)
class Judge:
    """Worlds to judge in, and by which rules. Raises what loading and playing raise."""

    client: RolloutClient
    rules: Rules
    device: str = "cpu"

    def checkpoints(
        self, paths: Sequence[Path], purpose: Purpose, kept_in: Path | None = None
    ) -> list[Evaluation]:
        """Checkpoints of one task and rate together, in the same worlds; failures are kept in the folder `kept_in`."""
        rules = self.rules
        policies = [load_policy(path, self.device) for path in paths]
        seeds = world_seeds(purpose, rules.world_seed, rules.number(purpose))
        courses = play(policies, self.client, seeds, rules.world_seed, rules.time_limit_s)
        return [
            self._evaluation(path, purpose, own, kept_in) for path, own in zip(paths, courses, strict=True)
        ]

    def new(self, run: RunDirectory, said: Said) -> None:
        """Every checkpoint of the run that these worlds have not seen yet, all seeds of a checkpoint together."""
        known = {(found.updates, found.seed) for found in self.known(run, Purpose.SELECTION)}
        for updates in run.checkpointed():
            seeds = [seed for seed in run.seeds(updates) if (updates, seed) not in known]
            self._of_run(run, [run.checkpoint(updates, seed) for seed in seeds], Purpose.SELECTION, said)

    def score(self, run: RunDirectory, said: Said) -> None:
        """The best checkpoint of each seed, where it has not been scored yet."""
        if not self.rules.score_episodes:
            return
        scored = {(found.updates, found.seed) for found in self.known(run, Purpose.SCORE)}
        of_seed: defaultdict[int, list[Evaluation]] = defaultdict(list)
        for found in self.known(run, Purpose.SELECTION):
            of_seed[found.seed].append(found)
        chosen = [result.best(found) for _, found in sorted(of_seed.items())]
        paths = [run.checkpoint(b.updates, b.seed) for b in chosen if (b.updates, b.seed) not in scored]
        self._of_run(run, paths, Purpose.SCORE, said)

    def known(self, run: RunDirectory, purpose: Purpose) -> list[Evaluation]:
        """What was said by the same rules about checkpoints that are still there."""
        rules = self.rules
        return [
            found
            for found in result.read(run.evaluations)
            if found.purpose is purpose
            and (found.world_seed, len(found.played)) == (rules.world_seed, rules.number(purpose))
            and rules.time_limit_s in (None, found.time_limit_s)
            and run.checkpoint(found.updates, found.seed).is_dir()
        ]

    def _of_run(self, run: RunDirectory, paths: Sequence[Path], purpose: Purpose, said: Said) -> None:
        if not paths:
            return
        made = self.checkpoints(paths, purpose, run.path / "rollouts")
        made = [found.model_copy(update={"checkpoint": _below(run, found)}) for found in made]
        result.append(run.evaluations, made)
        for found in made:
            said(found)

    def _evaluation(
        self, path: Path, purpose: Purpose, courses: Sequence[Course], kept_in: Path | None
    ) -> Evaluation:
        record = read_record(path)
        task = get_task(record.task, len(record.arms))
        names: dict[int, str] = {}
        if kept_in is not None:
            most = self.rules.kept if purpose is Purpose.SCORE else min(1, self.rules.kept)
            failed = [i for i, course in enumerate(courses) if course.played.outcome != "success"][:most]
            names = {i: f"{purpose}-{record.updates}-seed-{record.seed}-{i}" for i in failed}
            camera = Camera(self.client, task, record.control_hz, record.name)
            camera.keep({kept_in / f"{name}.mcap": courses[i] for i, name in names.items()})
        return Evaluation(
            at_ns=clock.wall_ns(),
            model=record.name,
            task=record.task,
            seed=record.seed,
            updates=record.updates,
            checkpoint=str(path),
            purpose=purpose,
            world_seed=self.rules.world_seed,
            time_limit_s=self.rules.time_limit_s or task.trial_limit_s,
            played=tuple(
                course.played.model_copy(update={"rollout": names.get(i, "")})
                for i, course in enumerate(courses)
            ),
        )


def run_of(checkpoint: Path) -> RunDirectory | None:
    """The run that a checkpoint is of, where it lies in one."""
    folder = checkpoint.resolve()
    for parent in folder.parents[:3]:
        run = RunDirectory(parent)
        if folder.is_relative_to(run.checkpoints) and (parent / "run.json").is_file():
            return run
    return None


def require_task(checkpoint: Path, task: str) -> None:
    """Raises InvalidInput where a checkpoint is of another task."""
    record = read_record(checkpoint)
    if record.task != task:
        raise InvalidInput(f"{checkpoint} was trained for {record.task}, not for {task}; give one that was.")


def _below(run: RunDirectory, evaluation: Evaluation) -> str:
    return run.checkpoint(evaluation.updates, evaluation.seed).relative_to(run.path).as_posix()
