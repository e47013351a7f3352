"""The report of a reproduction: whole or half, it shows what is there and says what is not."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.runtime.cli import cli
from mart.trainer.report.claims import compare_claims
from mart.trainer.report.paper import EXPERIENCED
from mart.trainer.report.reproduction import read_reproduction
from mart.trainer.report.reproduction_page import p_in_words
from tests.trainer.report.made_up_reproduction import make_up

CUBES, TRAY = "two_arm_multi_cube_lifting", "two_arm_drink_tray_lifting"
RATES = {CUBES: {"HBC": 0.4, "d-HBC": 0.85, "r-HBC": 0.85}, TRAY: {"HBC": 0.7, "d-HBC": 0.7}}


@pytest.fixture(scope="module")
def half(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("half")
    make_up(folder, RATES, failed="r-HBC")
    return folder


def test_a_half_table_says_what_is_missing_and_why(half: Path) -> None:
    found = read_reproduction(half)
    (missing,) = found.missing
    assert (missing.table, missing.task, missing.model) == ("table2", CUBES, "r-HBC")
    assert missing.why.startswith("training failed: The data hold no successful episode")
    assert (found.done, len(found.plan.steps)) == (8, 10)


def test_claims_are_tested_where_both_sides_are_there(half: Path) -> None:
    (table,) = read_reproduction(half).tables
    told = {(one.claim.name, one.task): one for one in table.claims}
    assert set(told) == {("apart", CUBES), ("together", TRAY)}
    apart = told["apart", CUBES]
    assert apart.comparison.difference.value > 0.2
    assert apart.comparison.p_value < 0.05
    assert apart.reported == pytest.approx(0.46)
    assert compare_claims([CUBES], {}, EXPERIENCED) == []


def test_the_command_writes_page_print_and_tables(half: Path) -> None:
    result = CliRunner().invoke(cli, ["report", "paper", str(half), "--json"])
    assert result.exit_code == 0, result.output
    told = json.loads(result.output)
    page = (half / "report" / "index.html").read_text()
    assert "1 cells are missing or not whole" in page
    assert "paper 84.5 ± 2.5" in page
    assert "mart train --model d-HBC" in page
    assert not re.search(r"(src|href)=\"?https?:", page)
    assert (half / "report" / "report.pdf").read_bytes().startswith(b"%PDF")
    with (half / "report" / "cells.csv").open() as file:
        rows = {(row["task"], row["model"]): row for row in csv.DictReader(file)}
    assert rows[CUBES, "r-HBC"]["missing"].startswith("training failed")
    assert float(rows[CUBES, "d-HBC"]["fresh_low"]) < float(rows[CUBES, "d-HBC"]["fresh"])
    assert len(told["files"]) == 5


def test_a_cell_with_fewer_seeds_than_asked_for_is_not_whole(tmp_path: Path) -> None:
    make_up(tmp_path, {CUBES: {"HBC": 0.4}})
    evaluations = tmp_path / "runs" / "table2" / CUBES / "HBC" / "evaluations.jsonl"
    lines = evaluations.read_text().splitlines(keepends=True)
    evaluations.write_text("".join(line for line in lines if '"seed":2,"updates"' not in line))
    (missing,) = read_reproduction(tmp_path).missing
    assert missing.why == "2 of 3 seeds are there"


def test_two_runs_are_compared_pair_by_pair(half: Path) -> None:
    runs = [half / "runs" / "table2" / CUBES / model for model in ("d-HBC", "HBC")]
    for run in runs:
        (run / "run.json").write_text(json.dumps({"model": run.name, "data": ["/d"]}))
    result = CliRunner().invoke(cli, ["report", "compare", *map(str, runs)])
    assert result.exit_code == 0, result.output
    assert "d-HBC (A) and HBC (B), 3 seeds in 100 worlds, 300 pairs" in result.output
    told = json.loads(CliRunner().invoke(cli, ["report", "compare", *map(str, runs), "--json"]).output)
    back = json.loads(CliRunner().invoke(cli, ["report", "compare", *map(str, runs[::-1]), "--json"]).output)
    assert told["p_value"] == back["p_value"]
    assert told["difference"] == -back["difference"]


def test_what_cannot_be_reported_is_said(half: Path, tmp_path: Path) -> None:
    with pytest.raises(NotFound, match="mart reproduce"):
        read_reproduction(tmp_path)
    (tmp_path / "plan.json").write_text("{}")
    with pytest.raises(Corrupt, match=r"plan\.json"):
        read_reproduction(tmp_path)
    runs = [half / "runs" / "table2" / task / "HBC" for task in (CUBES, TRAY)]
    for run in runs:
        (run / "run.json").write_text(json.dumps({"model": "HBC", "data": ["/d"]}))
    result = CliRunner().invoke(cli, ["report", "compare", *map(str, runs)])
    assert isinstance(result.exception, InvalidInput)


@pytest.mark.parametrize(
    ("p", "words"), [(0.0001, "< 0.001"), (0.0291, "0.029"), (0.634, "0.63"), (1.0, "1.00")]
)
def test_p_values_claim_no_more_digits_than_they_have(p: float, words: str) -> None:
    assert p_in_words(p) == words


def test_runs_of_other_arms_or_rates_are_not_compared(half: Path) -> None:
    runs = [half / "runs" / "table2" / CUBES / model for model in ("HBC", "d-HBC")]
    for run, control_hz in zip(runs, (20.0, 30.0), strict=True):
        (run / "run.json").write_text(json.dumps({"model": run.name, "data": ["/d"]}))
        (run / "data.json").write_text(json.dumps({"task": CUBES, "control_hz": control_hz}))
    try:
        result = CliRunner().invoke(cli, ["report", "compare", *map(str, runs)])
    finally:
        for run in runs:
            (run / "data.json").unlink()
    assert isinstance(result.exception, InvalidInput)
    assert "30 Hz" in str(result.exception)
