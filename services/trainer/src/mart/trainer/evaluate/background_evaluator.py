"""Evaluate the checkpoints of a run while it is trained, as they come."""

from __future__ import annotations

import contextlib
import logging

from mart.protocol.errors import Unavailable
from mart.rollouts.replicas import worlds
from mart.trainer.evaluate import formatting
from mart.trainer.evaluate.config import EvalConfig, EvaluationSpec
from mart.trainer.evaluate.evaluation import Evaluation
from mart.trainer.evaluate.evaluator import Evaluator
from mart.trainer.train.run_directory import RunDirectory

_log = logging.getLogger(__name__)


class BackgroundEvaluator:
    """Evaluate a run while it is trained; worlds are asked for when the first checkpoint is there.

    stack: what the worlds are closed with.
    """

    def __init__(self, run: RunDirectory, spec: EvaluationSpec, stack: contextlib.ExitStack) -> None:
        self._run = run
        self._spec = spec
        self._stack = stack
        self._evaluator: Evaluator | None = None
        self._known: tuple[int, ...] = ()
        self._is_away = False

    def evaluate_new(self) -> None:
        """Evaluate new checkpoints. Where no world can be reached, training goes on, and `finish` tries again."""
        checkpointed = self._run.checkpointed()
        if self._is_away or checkpointed == self._known or not self._spec.episodes:
            return
        self._known = checkpointed
        try:
            self._require_evaluator().evaluate_new(self._run, _log_evaluation)
        except Unavailable as error:
            _log.warning("Judging waits for the end of the training: %s", error)
            self._is_away = True

    def finish(self) -> None:
        """Evaluate the checkpoints that are left, then score the best ones. Raises Unavailable."""
        if self._spec.episodes:
            evaluator = self._require_evaluator()
            evaluator.evaluate_new(self._run, _log_evaluation)
            evaluator.score_best(self._run, _log_evaluation)

    def _require_evaluator(self) -> Evaluator:
        if self._evaluator is None:
            client = self._stack.enter_context(worlds(self._spec.replicas))
            config = EvalConfig(self._spec.episodes, self._spec.score_episodes)
            self._evaluator = Evaluator(client, config)
        return self._evaluator


def _log_evaluation(evaluation: Evaluation) -> None:
    _log.info("%s", formatting.line(evaluation))
