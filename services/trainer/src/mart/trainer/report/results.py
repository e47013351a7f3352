"""What runs achieve, by model and task, beside what the paper reports."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.protocol.errors import NotFound
from mart.trainer.evaluate.comparison import successes_by_world
from mart.trainer.evaluate.crossed import rate_interval
from mart.trainer.evaluate.evaluation import Evaluation, read_evaluations
from mart.trainer.evaluate.selection_bias import expected_best
from mart.trainer.evaluate.statistics import Spread
from mart.trainer.evaluate.success_rates import SuccessRates, best_scores, success_rates
from mart.trainer.evaluate.world_seeds import Purpose
from mart.trainer.report import paper


@dataclass(frozen=True)
class Cell:
    """One model on one task."""

    rates: SuccessRates
    evaluations: tuple[Evaluation, ...]

    @property
    def learning_curve(self) -> list[tuple[int, float]]:
        """Success rate of the checkpoints over updates, averaged over seeds."""
        rates: defaultdict[int, list[float]] = defaultdict(list)
        for found in self.evaluations:
            if found.purpose is Purpose.SELECTION:
                rates[found.updates].append(found.rate.value)
        return [(updates, sum(own) / len(own)) for updates, own in sorted(rates.items())]

    @property
    def fresh_interval(self) -> tuple[float, float] | None:
        """The 95 % interval of the rate in fresh worlds, over seeds and worlds; None before there are scores."""
        table = successes_by_world(best_scores(self.evaluations), Purpose.SCORE)
        return None if table is None else rate_interval(table)

    @property
    def selection_bias(self) -> float | None:
        """What choosing the best of equal checkpoints, each as good as the fresh rate, would add to it on average."""
        if self.rates.pooled is None:
            return None
        rate, checkpoints = self.rates.pooled.value, len(self.learning_curve)
        return expected_best(rate, checkpoints, self.rates.episodes) - rate

    @property
    def failures(self) -> dict[str, float]:
        """Subtask that was missing first → share of the fresh episodes, where there are any."""
        scored = [found for found in self.evaluations if found.purpose is Purpose.SCORE]
        counted = sum((Counter(found.failures) for found in scored), Counter[str]())
        episodes = sum(len(found.played) for found in scored)
        return {name: count / episodes for name, count in counted.items()}


@dataclass(frozen=True)
class Results:
    """What runs achieve. cells: by task, then by model. reported: the paper's, in per cent."""

    title: str
    cells: Mapping[str, Mapping[str, Cell]]
    reported: paper.Results

    @property
    def tasks(self) -> list[str]:
        """Names of the tasks, the paper's in its order, then the others."""
        known = list(paper.TITLES)
        return sorted(self.cells, key=lambda task: known.index(task) if task in known else len(known))

    def models(self, task: str) -> list[str]:
        """Return the models of a task, the paper's in its order, then the others."""
        known = list(paper.EXPERIENCED)
        return sorted(
            self.cells[task], key=lambda model: (known.index(model) if model in known else len(known), model)
        )

    def paper(self, model: str, task: str) -> Spread | None:
        """Return what the paper reports of a model on a task, in per cent; None where it does not."""
        return self.reported.get(model, {}).get(task)


def read_results(folder: Path, title: str, reported: paper.Results) -> Results:
    """Read every run below a folder; runs of the same model on the same task count as more seeds of it.

    Raises NotFound where no run was judged.
    """
    found: defaultdict[tuple[str, str], list[Evaluation]] = defaultdict(list)
    for number, path in enumerate(sorted(folder.rglob("evaluations.jsonl"))):
        for evaluation in _by_newest_rules(read_evaluations(path)):
            own = evaluation.model_copy(update={"seed": evaluation.seed + number * _SEEDS_OF_A_RUN})
            found[evaluation.task, evaluation.model].append(own)
    cells: dict[str, dict[str, Cell]] = {}
    for (task, model), evaluations in found.items():
        judged = success_rates(evaluations)
        if judged is not None:
            cells.setdefault(task, {})[model] = Cell(judged, tuple(evaluations))
    if not cells:
        raise NotFound(f"No run in {folder} was judged; `mart eval --checkpoint RUN` judges one.")
    return Results(title, cells, reported)


def _by_newest_rules(evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Return those that were made as the newest of their purpose was: others cannot be compared with them."""

    def rules(evaluation: Evaluation) -> tuple[int, int, float]:
        return evaluation.world_seed, len(evaluation.played), evaluation.time_limit_s

    newest = {evaluation.purpose: rules(evaluation) for evaluation in evaluations}
    return [evaluation for evaluation in evaluations if rules(evaluation) == newest[evaluation.purpose]]


_SEEDS_OF_A_RUN = 2**31  # seed 0 of two runs are two seeds


def in_words(results: Results) -> str:
    """Return the results in lines, a block a task and a row a model."""
    lines = [
        results.title,
        "Success in %: best checkpoint of each seed (mean ± deviation) | in fresh worlds | the paper",
    ]
    for task in results.tasks:
        lines += ["", paper.TITLES.get(task, task)]
        for model in results.models(task):
            judged = results.cells[task][model].rates
            fresh = "–" if judged.honest is None else f"{_percent(judged.honest)} {_interval(judged)}"
            reported = results.paper(model, task)
            beside = "–" if reported is None else f"{reported.mean:.1f} ± {reported.deviation:.1f}"
            lines.append(
                f"  {model:<12} {_percent(judged.paper):>12} | {fresh:>22} | {beside:>12}  ({len(judged.seeds)} seeds)"
            )
    return "\n".join(lines)


def as_rows(results: Results) -> list[dict[str, object]]:
    """Return the results as plain data, rates as shares."""
    rows: list[dict[str, object]] = []
    for task in results.tasks:
        for model in results.models(task):
            cell = results.cells[task][model]
            judged, reported = cell.rates, results.paper(model, task)
            rows.append(
                {
                    "task": task,
                    "model": model,
                    "seeds": len(judged.seeds),
                    "episodes": judged.episodes,
                    "best_checkpoint": _spread(judged.paper),
                    "fresh": None if judged.honest is None else _spread(judged.honest),
                    "fresh_interval": None if judged.pooled is None else list(judged.pooled.interval),
                    "paper": None
                    if reported is None
                    else {"mean": reported.mean / 100, "deviation": reported.deviation / 100},
                    "failures": cell.failures,
                }
            )
    return rows


def _spread(spread: Spread) -> dict[str, float]:
    return {"mean": spread.mean, "deviation": spread.deviation}


def _percent(spread: Spread) -> str:
    return f"{100 * spread.mean:.1f} ± {100 * spread.deviation:.1f}"


def _interval(judged: SuccessRates) -> str:
    if judged.pooled is None:
        return ""
    low, high = judged.pooled.interval
    return f"({100 * low:.0f}–{100 * high:.0f})"
