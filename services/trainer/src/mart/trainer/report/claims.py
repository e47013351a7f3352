"""What the paper claims of its models, as pairs that can be compared, beside the differences that it reports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mart.protocol.errors import InvalidInput
from mart.trainer.evaluate.comparison import PairedComparison, compare_evaluations
from mart.trainer.evaluate.evaluation import Evaluation
from mart.trainer.evaluate.success_rates import best_scores
from mart.trainer.report import paper


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, and the pairs (better, worse) that it is about; tasks: none for all."""

    name: str
    sentence: str
    pairs: tuple[tuple[str, str], ...]
    tasks: tuple[str, ...] = ()


CLAIMS = (
    Claim(
        "residuals",
        "A residual raises its base: r-HBC over d-HBC, rd-HBC over HBC.",
        (("r-HBC", "d-HBC"), ("rd-HBC", "HBC")),
    ),
    Claim(
        "apart",
        "Arms that have nothing to do with one another are best left apart.",
        (("d-HBC", "HBC"),),
        (paper.CUBES,),
    ),
    Claim(
        "together",
        "Arms that coordinate for long are best planned together.",
        (("HBC", "d-HBC"),),
        (paper.TRAY, paper.WIPING),
    ),
    Claim("hierarchy", "Subgoals help: HBC over BC-RNN.", (("HBC", "BC-RNN"),)),
    Claim(
        "halves",
        "Taking only the planner or only the actor apart is no better than doing both or neither.",
        (("d-HBC", "dh-HBC"), ("d-HBC", "dl-HBC")),
    ),
)


@dataclass(frozen=True)
class ComparedClaim:
    """A pair of a claim on one task. reported: the paper's difference of best checkpoints, as a share; None without."""

    claim: Claim
    task: str
    comparison: PairedComparison
    reported: float | None


def compare_claims(
    tasks: Sequence[str],
    evaluations: Mapping[tuple[str, str], Sequence[Evaluation]],
    reported: paper.Results,
) -> list[ComparedClaim]:
    """Compare what there is of each claim's pairs. evaluations: by task and model, of one run each."""
    return [
        ComparedClaim(claim, task, comparison, _reported(reported, task, better, worse))
        for claim in CLAIMS
        for better, worse in claim.pairs
        for task in tasks
        if not claim.tasks or task in claim.tasks
        for comparison in _compared(evaluations.get((task, better), ()), evaluations.get((task, worse), ()))
    ]


def _compared(better: Sequence[Evaluation], worse: Sequence[Evaluation]) -> list[PairedComparison]:
    try:
        return [compare_evaluations(best_scores(better), best_scores(worse))]
    except InvalidInput:  # one is missing, or they share too little: the table says which
        return []


def _reported(reported: paper.Results, task: str, better: str, worse: str) -> float | None:
    one, other = (reported.get(model, {}).get(task) for model in (better, worse))
    return None if one is None or other is None else (one.mean - other.mean) / 100
