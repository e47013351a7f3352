"""Offer `mart episodes edit`: what of an episode is told on, without changing its file.

Heavy modules are imported inside: `mart --help` loads this file.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.runtime.cli import json_option, print_result
from mart.runtime.rate_option import skip_idle_option

if TYPE_CHECKING:
    from mart.episodes.labelled_episode import LabelledEpisode
    from mart.episodes.labels import LabelKind

_SECONDS = re.compile(r"([0-9]{1,6}(?:\.[0-9]{1,6})?)s")
_KINDS = ("cut", "skip", "split", "subtask")


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--cut", multiple=True, help="Ticks to leave out, such as 0-12, or 0s-0.6s; may be repeated.")
@click.option("--skip", multiple=True, help="Idle ticks to leave out, the motion going on after them.")
@click.option("--split", multiple=True, help="A tick at which a new segment begins.")
@click.option("--subtask", multiple=True, help="From which tick on a subtask is done: grasp=85, grasp=never.")
@skip_idle_option
@click.option("--undo", is_flag=True, help="Take back the newest edits; again: those before.")
@click.option("--redo", is_flag=True, help="Do again what was undone last.")
@json_option
def edit(
    *,
    paths: tuple[Path, ...],
    skip_idle_s: float | None,
    undo: bool,
    redo: bool,
    as_json: bool,
    **wanted: tuple[str, ...],
) -> None:
    """Leave out, split or tell otherwise what episodes hold; without options, show their edits.

    Files never change: edits are labels, and training, exports and data sets follow them. What is said at once is
    undone at once. Ticks are the recorded ones, the first and the one after the last; times such as 1.5s-3s become
    ticks.
    """
    from mart.episodes.folder import described, episode_files
    from mart.recorder import edit_formatting
    from mart.recorder.catalogue import episode_editing

    edits = any(wanted.values()) or skip_idle_s is not None
    if edits + undo + redo > 1:
        raise InvalidInput("Edits, --undo and --redo were given together; one of them can be done at a time.")
    rows = [_readable(row) for row in described(episode_files(paths))]
    now_ns = clock.wall_ns()
    if undo:
        done = [episode_editing.undo(row, None, now_ns) for row in rows]
    elif redo:
        done = [episode_editing.redo(row, now_ns) for row in rows]
    else:
        said = [_said(row, wanted, skip_idle_s) for row in rows]
        for row, one in zip(rows, said, strict=True):
            episode_editing.check(row, one)  # all, before any is written
        done = [episode_editing.edit(row, one, now_ns) for row, one in zip(rows, said, strict=True)]
    print_result(*edit_formatting.edited(done), as_json)


def _readable(row: LabelledEpisode) -> LabelledEpisode:
    row.open()
    return row


def _said(
    row: LabelledEpisode, wanted: dict[str, tuple[str, ...]], skip_idle_s: float | None
) -> list[tuple[LabelKind, str]]:
    from mart.episodes.labels import LabelKind
    from mart.recorder.catalogue.episode_editing import idle_skips

    said = [(LabelKind(kind), _in_ticks(row, value)) for kind in _KINDS for value in wanted[kind]]
    return said if skip_idle_s is None else [*said, *idle_skips(row, skip_idle_s)]


def _in_ticks(row: LabelledEpisode, value: str) -> str:
    """Return `1.5s-3s` as `30-60`, of 20 ticks a second; what is ticks already stays. Raises InvalidInput."""
    name, equals, when = value.rpartition("=")
    parts = [_tick(row, part) for part in when.split("-")]
    return f"{name}{equals}{'-'.join(parts)}"


def _tick(row: LabelledEpisode, text: str) -> str:
    found = _SECONDS.fullmatch(text)
    if found is None:
        return text
    if not row.control_hz:
        raise InvalidInput(f"{row.file_path} does not say its control rate; give ticks instead of {text}.")
    return str(round(float(found[1]) * row.control_hz))
