"""`mart report …`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.trainer.report import paper

_MISSING_TOLD = 8

_folder = click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
_page = click.option(
    "--html", type=click.Path(path_type=Path, dir_okay=False), help="Also write a page here."
)


@click.group()
def report() -> None:
    """The paper's tables and figures, from episodes and runs."""


@report.command()
@_folder
@json_option
def coordination(folder: Path, as_json: bool) -> None:
    """Table I: what coordinated and uncoordinated subtasks cost the operators of the episodes in FOLDER."""
    from mart.trainer.report import degradation
    from mart.trainer.report.attempts import read_attempts

    rows = [degradation.row(attempts.task, attempts.attempts) for attempts in read_attempts(folder)]
    print_result({"tasks": rows}, degradation.text(rows), as_json)


@report.command()
@_folder
@_page
@json_option
def table2(folder: Path, html: Path | None, as_json: bool) -> None:
    """Table II: what the judged runs in FOLDER achieve, beside the paper's figures for experienced operators."""
    from mart.trainer.report import paper

    _table("Table II: experienced operators", folder, paper.EXPERIENCED, html, as_json=as_json)


@report.command()
@_folder
@_page
@json_option
def table3(folder: Path, html: Path | None, as_json: bool) -> None:
    """Table III: what the judged runs in FOLDER achieve, beside the paper's figures for the user study."""
    from mart.trainer.report import paper

    _table("Table III: user study", folder, paper.USER_STUDY, html, as_json=as_json)


@report.command()
@_folder
@click.option(
    "--checkpoint",
    "checkpoints",
    multiple=True,
    type=click.Path(path_type=Path),
    help="A joint model whose reliance on the others is shown beside; may be repeated, one a task.",
)
@_page
@json_option
def dependence(folder: Path, checkpoints: tuple[Path, ...], html: Path | None, as_json: bool) -> None:
    """How much each arm's next action depends on the other arms, over the successful episodes in FOLDER."""
    from mart.trainer.models.checkpoint import read_record
    from mart.trainer.models.policies.load import load_policy
    from mart.trainer.report.coupling import read_couplings

    names = sorted({read_record(path).name for path in checkpoints})
    couplings = read_couplings(folder, [load_policy(path) for path in checkpoints])
    lines = [
        "Share of an arm's action error that knowing the other arms removes, held out, over whole episodes"
    ]
    for coupling in couplings:
        arms = ", ".join(f"{arm.name} {100 * own.overall:.1f} %" for arm, own in coupling.found.items())
        lines.append(f"{coupling.task.title}: {arms}  ({coupling.episodes} episodes)")
    if html is not None:
        from mart.trainer.report.html import dependence_page, save

        save(html, dependence_page(couplings, " and ".join(names)))
        lines.append(f"The page is {html}.")
    print_result({"tasks": [coupling.as_json() for coupling in couplings]}, "\n".join(lines), as_json)


@report.command()
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path))
@click.option("--task", default="", help="Only of this task.")
@click.option(
    "--by",
    type=click.Choice(["operator", "day", "episode"]),
    default="operator",
    show_default=True,
    help="What the table compares.",
)
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Also write a page here.")
@json_option
def quality(paths: tuple[Path, ...], task: str, by: str, out: Path | None, as_json: bool) -> None:
    """How well episodes were recorded and driven, who drove how, and which are unlike the others.

    Without PATHS, of all that were recorded here. Nothing is left out for it: see docs/how-to-judge-your-data.md.
    """
    from mart.runtime.progress import tracked
    from mart.runtime.settings import Settings
    from mart.trainer.report import quality as measured

    given = paths or (Settings().episodes_dir,)
    found = measured.read_quality(given, task, lambda listed: tracked(listed, "Measured", as_json=as_json))
    text = measured.in_words(found, by)
    if out is not None:
        from mart.trainer.report.html import save
        from mart.trainer.report.quality_page import quality_page

        save(out, quality_page(found))
        text += f"\n\nThe page is {out}."
    print_result(measured.as_json(found, by), text, as_json)


@report.command("paper")
@_folder
@json_option
def reproduction(folder: Path, as_json: bool) -> None:
    """The report of `mart reproduce` in FOLDER, however far that has come: HTML, PDF and CSV in FOLDER/report."""
    from mart.trainer.report.html import save
    from mart.trainer.report.reproduction import read_reproduction
    from mart.trainer.report.reproduction_page import missing_in_words, reproduction_page, summary
    from mart.trainer.report.reproduction_pdf import write_pdf
    from mart.trainer.report.reproduction_tables import write_tables

    found = read_reproduction(folder)
    out = folder / "report"
    save(out / "index.html", reproduction_page(found))
    write_pdf(out / "report.pdf", found)
    paths = [out / "index.html", out / "report.pdf", *write_tables(out, found)]
    missing = [missing_in_words(cell) for cell in found.missing]
    text = [summary(found), *missing[:_MISSING_TOLD]]
    if len(missing) > _MISSING_TOLD:
        text.append(f"… and {len(missing) - _MISSING_TOLD} more; the page lists all.")
    text.append(f"The report is {paths[0]}, and report.pdf and three tables beside it.")
    print_result({"missing": missing, "files": [str(path) for path in paths]}, "\n".join(text), as_json)


@report.command()
@click.argument("run_a", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("run_b", type=click.Path(path_type=Path, exists=True, file_okay=False))
@json_option
def compare(run_a: Path, run_b: Path, as_json: bool) -> None:
    """Two judged runs of one task, pair by pair: the same seeds in the same fresh worlds."""
    from mart.trainer.evaluate.comparison import compare_evaluations
    from mart.trainer.evaluate.evaluation import read_evaluations
    from mart.trainer.evaluate.success_rates import best_scores
    from mart.trainer.report.comparable_runs import require_comparable
    from mart.trainer.report.comparison_words import as_plain_data, in_lines
    from mart.trainer.train.run_directory import RunDirectory

    runs = [RunDirectory(path) for path in (run_a, run_b)]
    require_comparable(runs)
    first, second = (best_scores(read_evaluations(run.evaluations)) for run in runs)
    found = compare_evaluations(first, second)
    print_result(as_plain_data(found), in_lines(found), as_json)


def _table(title: str, folder: Path, reported: paper.Results, html: Path | None, *, as_json: bool) -> None:
    from mart.trainer.report.results import as_rows, in_words, read_results

    results = read_results(folder, title, reported)
    text = in_words(results)
    if html is not None:
        from mart.trainer.report.html import results_page, save

        save(html, results_page(results))
        text += f"\n\nThe page is {html}."
    print_result({"title": title, "rows": as_rows(results)}, text, as_json)
