"""Run `mart episodes export`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import GOOD_VERDICTS, EpisodeOutcome
from mart.recorder.filter_options import OUTCOMES, VERDICTS, filter_of, word_option
from mart.recorder.hub_options import hub_options
from mart.recorder.settings import given_or_recorded
from mart.recorder.view_export_cli import VIEWS, export_views
from mart.runtime.cli import json_option, print_result
from mart.runtime.progress import tracked
from mart.runtime.rate_option import control_hz_option, skip_idle_option

if TYPE_CHECKING:
    from collections.abc import Callable

    from mart.recorder.export.selection import ExportSelection
    from mart.recorder.storage.hub import HubTarget


@click.command()
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--format",
    "file_format",
    type=click.Choice(["robomimic", "lerobot", *VIEWS]),
    required=True,
    help="Whose data set it is, or whose viewer shall show each episode.",
)
@click.option(
    "--out", type=click.Path(path_type=Path), required=True, help="The file or folder to be written."
)
@word_option("--outcome", OUTCOMES, EpisodeOutcome.SUCCESS.value)
@word_option("--verdict", VERDICTS, *GOOD_VERDICTS)
@click.option("--dataset", default="", help="Only of this data set.")
@control_hz_option
@skip_idle_option
@click.option(
    "--camera",
    "cameras",
    multiple=True,
    metavar="NAME:WIDTHxHEIGHT",
    help="Pictures of this camera, too, such as arm0:224x224; several times.",
)
@click.option("--depth", is_flag=True, help="Beside each picture, how far away things are (robomimic).")
@click.option("--segmentation", is_flag=True, help="Beside each picture, what each pixel shows (robomimic).")
@click.option(
    "--jobs", type=click.IntRange(1, 64), help="How many processes draw pictures.  [default: the cores]"
)
@click.option(
    "--layout",
    type=click.Path(path_type=Path),
    help="Write a layout for Foxglove, too, that shows all at once.",
)
@click.option("--with-names", is_flag=True, help="Say in the data set and its card who drove, by name.")
@click.option(
    "--push",
    "repo",
    metavar="OWNER/NAME",
    help="Bring it to a hub, too (huggingface.co or HF_ENDPOINT), private.",
)
@hub_options
@json_option
def export(
    *,
    paths: tuple[Path, ...],
    file_format: str,
    out: Path,
    dataset: str,
    control_hz: float | None,
    skip_idle_s: float | None,
    cameras: tuple[str, ...],
    depth: bool,
    segmentation: bool,
    jobs: int | None,
    with_names: bool,
    layout: Path | None,
    repo: str | None,
    public: bool,
    over: bool,
    as_json: bool,
    **wanted: Any,
) -> None:
    """Write episodes of one task as a data set of another project; dropped ones are left out.

    One that was interrupted goes on where it was when the same is asked for again. For a viewer (foxglove, rerun) each
    episode becomes a file of its own, whatever its task is and however it ended.
    """
    from mart.recorder.export.cameras import captured_cameras, parse_cameras
    from mart.recorder.storage.hub import push_export

    target = _target(file_format, repo, public=public, over=over)
    if file_format in VIEWS:
        wanted["dataset"] = dataset
        export_views(given_or_recorded(paths), file_format, out, layout, wanted, as_json=as_json)
        return
    if layout is not None:
        raise InvalidInput("--layout is for --format foxglove; leave it out.")
    asked_cameras = parse_cameras(cameras)
    selection, listed = _chosen(paths, dataset, control_hz, wanted)
    selection = replace(
        selection,
        cameras=asked_cameras,
        captured=captured_cameras(selection.episodes, asked_cameras),
        skip_idle_s=skip_idle_s,
        depth=depth,
        segmentation=segmentation,
        with_names=with_names,
        # Numbers are read faster than processes start.
        jobs=(jobs or len(os.sched_getaffinity(0))) if asked_cameras else 1,
        each=partial(tracked, label="Episodes", as_json=as_json),
    )
    ticks = _writer(file_format)(selection, out)
    count, task = len(selection.episodes), selection.task.name
    result = {"path": str(out), "format": file_format, "task": task, "episodes": count, "ticks": ticks}
    result |= {"control_hz": selection.control_hz, "cameras": [*map(str, asked_cameras)]}
    text = f"{out}: {count} of {listed} episodes of {task}, {ticks} ticks of {selection.control_hz:g} Hz."
    if target is not None:
        result["url"] = push_export(out, target)
        text = f"{text} It is at {result['url']}."
    print_result(result, text, as_json)


def _target(file_format: str, repo: str | None, *, public: bool, over: bool) -> HubTarget | None:
    """Return where on a hub the data set goes, which was asked; None where nothing was said of one."""
    from mart.recorder.storage.hub import HubTarget, require_reachable

    if repo is None:
        return None
    if file_format in VIEWS:
        raise InvalidInput("--push is for data sets; leave it out, or export --format lerobot or robomimic.")
    target = HubTarget(repo, public, over)
    require_reachable(target)
    return target


def _writer(file_format: str) -> Callable[[ExportSelection, Path], int]:
    from mart.recorder.export.lerobot import write_lerobot
    from mart.recorder.export.robomimic import write_robomimic

    return write_robomimic if file_format == "robomimic" else write_lerobot


def _chosen(
    paths: tuple[Path, ...], dataset: str, control_hz: float | None, wanted: dict[str, Any]
) -> tuple[ExportSelection, int]:
    """Choose what is written, every byte of it read; returns it, and how many episodes there were to choose from."""
    from mart.episodes.filter import EpisodeFilter
    from mart.episodes.folder import readable
    from mart.recorder.catalogue.episode_catalogue import list_paths
    from mart.recorder.export.selection import choose, sound

    of_dataset = EpisodeFilter(datasets=(dataset,) if dataset else (), unusable=True)
    listed = of_dataset.apply(list_paths(given_or_recorded(paths)))
    asked = filter_of(wanted, unusable=False)
    taken = readable(sound(asked.apply(readable(listed, paths))), paths)
    return choose(taken or [one for one in listed if one.error is None], asked, control_hz), len(listed)
