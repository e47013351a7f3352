"""A reproduction as tables for other programs (CSV): its cells, its comparisons, its steps."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.trainer.report.reproduction import ReproducedTable, Reproduction
from mart.trainer.report.reproduction_page import rows_and_columns


def write_tables(folder: Path, found: Reproduction) -> list[Path]:
    """Write cells.csv, comparisons.csv and steps.csv, rates as shares; return where they are."""
    missing = {(cell.table, cell.task, cell.model): cell.why for cell in found.missing}
    cells = [row for table in found.tables for row in _cells(table, missing)]
    rows = {"cells": cells, "comparisons": list(_comparisons(found)), "steps": list(_steps(found))}
    paths = []
    for name, own in rows.items():
        paths.append(folder / f"{name}.csv")
        write_atomically(paths[-1], _csv(own).encode(), PUBLIC)
    return paths


def _cells(table: ReproducedTable, missing: Mapping[tuple[str, str, str], str]) -> Iterable[dict[str, Any]]:
    models, tasks = rows_and_columns(table)
    for task in tasks:
        for model in models:
            cell = table.results.cells.get(task, {}).get(model) if table.results else None
            reported = table.results.paper(model, task) if table.results else None
            rates = cell.rates if cell else None
            low, high = (cell.fresh_interval if cell else None) or ("", "")
            yield {
                "table": table.name,
                "task": task,
                "model": model,
                "seeds": len(rates.seeds) if rates else 0,
                "best_mean": rates.paper.mean if rates else "",
                "best_deviation": rates.paper.deviation if rates else "",
                "fresh": rates.pooled.value if rates and rates.pooled else "",
                "fresh_low": low,
                "fresh_high": high,
                "fresh_episodes": rates.pooled.trials if rates and rates.pooled else 0,
                "choosing_adds": "" if cell is None or cell.selection_bias is None else cell.selection_bias,
                "paper_mean": reported.mean / 100 if reported else "",
                "paper_deviation": reported.deviation / 100 if reported else "",
                "missing": missing.get((table.name, task, model), ""),
            }


def _comparisons(found: Reproduction) -> Iterable[dict[str, Any]]:
    for table in found.tables:
        for one in table.claims:
            paired, (low, high) = one.comparison, one.comparison.interval
            yield {
                "table": table.name,
                "claim": one.claim.name,
                "task": one.task,
                "first": paired.first,
                "second": paired.second,
                "difference": paired.difference.value,
                "low": low,
                "high": high,
                "p_seeds_and_worlds": paired.p_value,
                "p_mcnemar": paired.mcnemar_p,
                "only_first": paired.only_first,
                "only_second": paired.only_second,
                "seeds": paired.seeds,
                "worlds": paired.worlds,
                "paper_difference": "" if one.reported is None else one.reported,
            }


def _steps(found: Reproduction) -> Iterable[dict[str, Any]]:
    for name, record in found.records.items():
        yield {
            "step": name,
            "status": record.status,
            "wall_s": round(record.wall_s, 1),
            "attempts": len(record.attempts),
            "seeds": " ".join(map(str, record.step.seeds)),
            "command": f"mart {' '.join(record.step.command)}",
            "inputs": " ".join(f"{path}={sha256}" for path, sha256 in record.inputs.items()),
            "result_sha256": record.result,
            "versions": " ".join(f"{part}={own}" for part, own in record.versions.items()),
            "note": record.note,
        }


def _csv(rows: list[dict[str, Any]]) -> str:
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(rows[0]) if rows else ["nothing"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()
