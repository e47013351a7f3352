"""How much of a run is evaluated, and where: for the evaluator, and as a job's file says it."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict

from mart.trainer.evaluate.world_seeds import Purpose


@dataclass(frozen=True)
class EvalConfig:
    """How many episodes an evaluation takes, and in which worlds.

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
        """Return how many episodes an evaluation for this purpose takes."""
        return self.episodes if purpose is Purpose.SELECTION else self.score_episodes


class EvaluationSpec(BaseModel):
    """How the checkpoints of a job are evaluated, as its file says it. replicas: running ones; none: one is started."""

    model_config = ConfigDict(frozen=True)

    task: str
    episodes: int = 30
    score_episodes: int = 100
    replicas: tuple[str, ...] = ()
