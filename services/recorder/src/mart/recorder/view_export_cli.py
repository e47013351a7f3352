"""Write episodes for viewers of other projects, for `mart episodes export --format foxglove` and `rerun`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from mart.protocol.errors import InvalidInput
from mart.recorder.filter_options import ANY, filter_of
from mart.runtime.cli import print_result

VIEWS = ("foxglove", "rerun")


def export_views(
    paths: tuple[Path, ...],
    file_format: str,
    out: Path,
    layout: Path | None,
    wanted: dict[str, Any],
    *,
    as_json: bool,
) -> None:
    """Write each episode that is wanted, however it ended unless that was asked for."""
    from mart.episodes.folder import readable
    from mart.recorder.catalogue.episode_catalogue import list_paths
    from mart.recorder.export.views import write_views

    if file_format == "foxglove":
        from mart.recorder.export.foxglove import write_foxglove as write

        suffix = ".mcap"
    else:
        from mart.recorder.export.rerun import write_rerun as write

        suffix = ".rrd"
    if layout is not None and file_format != "foxglove":
        raise InvalidInput("--layout is for Foxglove; a file for rerun carries its own.")
    listed = readable(filter_of(_asked(wanted), unusable=True).apply(list_paths(paths)), paths)
    views = write_views(listed, out, suffix, write)
    if layout is not None:
        from mart.recorder.export.foxglove_layout import write_layout

        write_layout(listed[0], layout)
    lines = [
        f"{view.path}: {view.shown.messages} messages, {view.shown.ticks} ticks, "
        + (
            f"{view.shown.bodies} bodies in 3D."
            if view.shown.bodies
            else "nothing in 3D: it carries no model."
        )
        for view in views
    ]
    if layout is not None:
        lines.append(f"{layout}: a layout with 3D, pictures and plots; import it in Foxglove or Lichtblick.")
    result = {
        "format": file_format,
        "episodes": [{"episode": str(v.episode), "path": str(v.path), **vars(v.shown)} for v in views],
        "layout": str(layout) if layout else None,
    }
    print_result(result, "\n".join(lines), as_json)


def _asked(wanted: dict[str, Any]) -> dict[str, Any]:
    """Return the filters; what the command takes where nothing is said is meant for training, and is left out."""
    context = click.get_current_context()
    defaults = {
        name: (ANY,) if isinstance(value, tuple) else ANY
        for name, value in wanted.items()
        if name in ("outcome", "verdict") and context.get_parameter_source(name) is ParameterSource.DEFAULT
    }
    return wanted | defaults
