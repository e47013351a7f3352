"""Write the page of a quality report: people and days beside each other, and what is unlike the others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mart.episodes.quality.comparison import COMPARED, By, judged_name, operators_of
from mart.trainer.report import plots
from mart.trainer.report.html import render_page
from mart.trainer.report.quality import TaskQuality, compared_groups, outlier_text, range_text


def quality_page(found: Sequence[TaskQuality]) -> str:
    """Return a page of figures, tables and outliers of each task."""
    return render_page(
        "quality.html", title="Quality of recorded episodes", tasks=[_task(one) for one in found]
    )


def _task(one: TaskQuality) -> dict[str, Any]:
    return {
        "title": one.task.replace("_", " "),
        "episodes": len(one.episodes),
        "judged": any(judged.usual for judged in one.episodes),
        "names": [judged_name(name) for name in COMPARED],
        "parts": [_part(one, "Operators", "operator"), _part(one, "Days", "day")],
        "odd": [
            {
                "name": judged.episode.path,
                "link": judged.episode.file_path.resolve().as_uri(),
                "who": ", ".join(operators_of(judged.episode)),
                "why": [outlier_text(outlier) for outlier in judged.outliers],
            }
            for judged in one.odd
        ],
    }


def _part(one: TaskQuality, title: str, by: By) -> dict[str, Any]:
    groups = compared_groups(one, by)
    return {
        "title": title,
        "figure": plots.ranges(groups, one.task),
        "rows": [
            {
                "name": group.name,
                "counts": (group.episodes, group.successes, group.outliers),
                "cells": [range_text(group, name) for name in COMPARED],
            }
            for group in groups
        ],
    }
