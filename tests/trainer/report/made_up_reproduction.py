"""A reproduction that nobody ran: evaluations with given success rates, and the records of its steps."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mart.runtime.step_record import Plan, PlannedStep, StepAttempt, StepRecord, write_plan, write_record
from mart.trainer.evaluate.evaluation import (
    EpisodeResult,
    Evaluation,
    RolloutOutcome,
    append_evaluations,
    best_evaluation,
)
from mart.trainer.evaluate.world_seeds import Purpose, world_seeds

CHECKPOINTS = (400, 800, 1200, 1600, 2000)
Rates = Mapping[str, Mapping[str, float]]  # task → model → true rate


def make_up(folder: Path, rates: Rates, table: str = "table2", seeds: int = 3, failed: str = "") -> None:
    """Write a table in which every cell of `rates` is judged; `failed`: a model whose training broke."""
    steps = []
    for task, row in rates.items():
        for model, rate in row.items():
            run = f"runs/{table}/{task}/{model}"
            train = PlannedStep(
                name=run, kind="train", command=("train", "--model", model, "--out", run), inputs=(f"data/{task}",),
                result=run, table=table, task=task, model=model, seeds=tuple(range(seeds)),
            )  # fmt: skip
            judge = PlannedStep(
                name=f"judged/{table}/{task}/{model}", kind="eval", command=("eval", "--checkpoint", run),
                inputs=(run,),
                result=f"{run}/evaluations.jsonl", after=(run,), table=table, task=task, model=model, seeds=(0,),
            )  # fmt: skip
            steps += [train, judge]
            if model == failed:
                _record(folder, train, "failed", "The data hold no successful episode")
                continue
            for step in (train, judge):
                _record(folder, step, "done")
            evaluations = _evaluations(task, model, rate, seeds)
            append_evaluations(folder / judge.result, evaluations)
            _curve(folder / run / "metrics.jsonl")
    plan = Plan(asked=("reproduce", table), preset="fast", tables=(table,), steps=tuple(steps))
    write_plan(folder, plan)


def _record(folder: Path, step: PlannedStep, status: str, why: str = "") -> None:
    record = {
        "step": step,
        "status": status,
        "inputs": dict.fromkeys(step.inputs, "c0ffee" * 10),
        "result": "" if why else "5eed" * 16,
        "attempts": [StepAttempt(began_ns=0, ended_ns=90 * 10**9, exit_code=int(bool(why)))],
        "versions": {"mart-trainer": "0.2.0", "torch": "2.9.0"},
        "why": why,
    }
    write_record(folder, StepRecord.model_validate(record))


def _evaluations(task: str, model: str, rate: float, seeds: int) -> list[Evaluation]:
    found = []
    for seed in range(seeds):
        random = np.random.default_rng([seed, *model.encode(), *task.encode()])
        own = np.clip(rate + random.normal(0.0, 0.03), 0.0, 1.0)
        chosen = [
            _evaluation(
                task,
                model,
                seed,
                updates,
                purpose=Purpose.SELECTION,
                number=30,
                rate=own * (0.7 + 0.3 * updates / 2000),
                random=random,
            )
            for updates in CHECKPOINTS
        ]
        best = best_evaluation(chosen).updates
        score = _evaluation(
            task, model, seed, best, purpose=Purpose.SCORE, number=100, rate=own, random=random
        )
        found += [*chosen, score]
    return found


def _evaluation(
    task: str,
    model: str,
    seed: int,
    updates: int,
    *,
    purpose: Purpose,
    number: int,
    rate: float,
    random: np.random.Generator,
) -> Evaluation:
    ease = np.random.default_rng(5).random(number)  # of the worlds, the same for all
    won = (0.5 * ease + 0.5 * random.random(number)) < np.quantile(
        0.5 * ease + 0.5 * random.random(number), rate
    )
    played = tuple(
        EpisodeResult(
            seed=world,
            outcome=RolloutOutcome.SUCCESS if win else RolloutOutcome.TIME,
            time_s=8.0,
            done=(),
        )
        for world, win in zip(world_seeds(purpose, 0, number), won, strict=True)
    )
    return Evaluation(
        at_ns=1, model=model, task=task, seed=seed, updates=updates, checkpoint=f"checkpoints/{updates}/seed-{seed}",
        purpose=purpose, world_seed=0, time_limit_s=10.5, played=played,
    )  # fmt: skip


def _curve(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = [
        {"updates": n, "stage": "base", "loss": 1 / n, "held_out/actor": 0.01 + 1 / n}
        for n in range(10, 2000, 50)
    ]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
