"""Tables II and III: ours beside the paper's, from the files of runs."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path

import pytest
from click.testing import CliRunner

from mart.protocol.errors import NotFound
from mart.trainer.evaluate.evaluation import append_evaluations
from mart.trainer.evaluate.world_seeds import Purpose
from mart.trainer.report import paper
from mart.trainer.report.cli import report
from mart.trainer.report.results import read_results
from tests.trainer.evaluate.test_statistics import TASK, evaluation


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """One model, two runs of one seed each; a third run of another model, not scored."""
    for name, successes in (("first", 12), ("second", 18)):
        path = tmp_path / name / "evaluations.jsonl"
        append_evaluations(path, [evaluation(3, 10)])  # by rules that were changed later
        append_evaluations(path, [evaluation(successes - 6, updates=100), evaluation(successes, updates=200)])
        append_evaluations(path, [evaluation(50, 100, updates=200, purpose=Purpose.SCORE)])
    other = [evaluation(30).model_copy(update={"model": "none/per-arm/joint"})]
    append_evaluations(tmp_path / "third" / "evaluations.jsonl", other)
    return tmp_path


def test_runs_of_a_model_are_its_seeds(runs: Path) -> None:
    results = read_results(runs, "Table II", paper.EXPERIENCED)
    judged = results.cells[TASK]["HBC"].rates
    assert (len(judged.seeds), judged.episodes) == (2, 30)
    assert (judged.paper.mean, judged.paper.deviation) == pytest.approx((0.5, 0.1))
    assert judged.pooled is not None
    assert (judged.pooled.hits, judged.pooled.trials) == (100, 200)
    assert results.models(TASK) == ["HBC", "none/per-arm/joint"]
    assert dict(results.cells[TASK]["HBC"].learning_curve) == pytest.approx({100: 0.3, 200: 0.5})
    assert results.cells[TASK]["HBC"].failures == {"lift_cube1": 0.5}


def test_the_command_prints_both_protocols_and_the_paper(runs: Path, tmp_path: Path) -> None:
    page = tmp_path / "report" / "table2.html"
    words = ["table2", str(runs), "--html", str(page)]
    text = CliRunner().invoke(report, words, catch_exceptions=False).output
    assert "50.0 ± 10.0 | 50.0 ± 0.0 (43–57) | 38.5 ± 3.8 (2 seeds)" in " ".join(text.split())
    assert "100.0 ± 0.0 | – | – (1 seeds)" in " ".join(text.split())
    assert page.read_text().count("<svg") == 2
    assert _Tags.unclosed(page.read_text()) == []
    rows = json.loads(CliRunner().invoke(report, ["table3", str(runs), "--json"]).output)["rows"]
    assert [(row["model"], row["paper"]) for row in rows] == [("HBC", None), ("none/per-arm/joint", None)]


def test_a_folder_without_judged_runs_is_said(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        read_results(tmp_path, "Table II", paper.EXPERIENCED)


def test_the_papers_figures_are_whole() -> None:
    assert [len(row) for row in paper.EXPERIENCED.values()] == [5] * 7
    assert [len(row) for row in paper.USER_STUDY.values()] == [3] * 4
    assert max(paper.EXPERIENCED, key=lambda model: paper.EXPERIENCED[model][paper.WIPING].mean) == "r-HBC"
    # 30 rollouts of five seeds: three of four means that are not 0 are a multiple of 1/150, as far as is printed
    means = [
        cell.mean
        for table in (paper.EXPERIENCED, paper.USER_STUDY)
        for row in table.values()
        for cell in row.values()
    ]
    fit = [mean for mean in means if mean and abs(mean - round(mean * 1.5) / 1.5) < 0.071]
    assert len(fit) / sum(mean > 0 for mean in means) > 0.7


class _Tags(HTMLParser):
    """Which elements are not closed in their order."""

    _VOID = frozenset({"meta", "br", "path", "use", "image", "rect", "link"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    @classmethod
    def unclosed(cls, page: str) -> list[str]:
        parser = cls()
        parser.feed(page)
        return parser.open

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in self._VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: object) -> None:
        """Opens nothing."""

    def handle_endtag(self, tag: str) -> None:
        if tag not in self._VOID:
            assert self.open.pop() == tag
