"""Put evaluations into words for people, and into plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mart.trainer.evaluate.evaluation import Evaluation
from mart.trainer.evaluate.statistics import Spread
from mart.trainer.evaluate.success_rates import success_rates


def line(evaluation: Evaluation) -> str:
    """Return an evaluation in one line: model, seed, updates, purpose and success rate."""
    where = f"{evaluation.model}, seed {evaluation.seed}, {evaluation.updates} updates, {evaluation.purpose}"
    return f"{where}: {evaluation.rate}"


def details(evaluation: Evaluation) -> str:
    """Return lines that tell what an evaluation reached and where it failed."""
    number = len(evaluation.played)
    time_s = evaluation.mean_success_time_s
    lines = [line(evaluation), f"  {number} episodes of at most {evaluation.time_limit_s:g} s"]
    if time_s is not None:
        lines.append(f"  success takes {time_s:.1f} s on average")
    lines += [f"  {name:<24} done in {done} of {number}" for name, done in evaluation.done.items()]
    lines += [f"  {count} failed at {name}" for name, count in evaluation.failures.items()]
    return "\n".join(lines)


def summary(evaluations: Sequence[Evaluation]) -> str:
    """Return one evaluation in full, or a run's success rates by both protocols."""
    if len(evaluations) == 1:
        return details(evaluations[0])
    found = success_rates(evaluations)
    if found is None:
        return "There is no checkpoint to judge."
    lines = [
        f"Best checkpoint of each of {len(found.seeds)} seeds, {found.episodes} episodes: {_percent(found.paper)}"
    ]
    if found.honest is not None and found.pooled is not None:
        lines.append(
            f"The same checkpoints in fresh worlds: {_percent(found.honest)}; all together {found.pooled}"
        )
    return "\n".join(lines)


def as_json(evaluation: Evaluation) -> dict[str, Any]:
    """Return an evaluation as plain data, what follows from it included."""
    low, high = evaluation.rate.interval
    return {
        **evaluation.model_dump(mode="json"),
        "success": evaluation.rate.value,
        "low": low,
        "high": high,
        "mean_success_time_s": evaluation.mean_success_time_s,
        "done": evaluation.done,
        "failures": evaluation.failures,
    }


def _percent(spread: Spread) -> str:
    return f"{100 * spread.mean:.1f} ± {100 * spread.deviation:.1f} %"
