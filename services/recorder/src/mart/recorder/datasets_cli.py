"""Run `mart datasets …`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from mart.protocol import clock
from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.vocabulary import GOOD_VERDICTS, EpisodeOutcome
from mart.recorder.filter_options import ANY, filter_of, filters
from mart.recorder.settings import RecorderSettings
from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.episodes.labelled_episode import LabelledEpisode
    from mart.recorder.catalogue.dataset_editing import DataSetEdit

_name = click.argument("name")
_paths = click.argument("paths", nargs=-1, type=click.Path(path_type=Path))


def _in_folder(_context: click.Context, _option: click.Parameter, given: Path | None) -> Path:
    folder = (given or RecorderSettings().episodes_dir).resolve()
    if not folder.is_dir():
        raise NotFound(f"There is no folder {folder}; name one with --folder, or record episodes first.")
    return folder


_folder = click.option(
    "--folder",
    type=click.Path(path_type=Path),
    callback=_in_folder,
    help="Whose episodes.  [default: data/episodes]",
)


@click.group()
def datasets() -> None:
    """Named data sets: episodes put together to be learned from. Files stay where they are."""


@datasets.command("list")
@_folder
@json_option
def list_datasets(folder: Path, as_json: bool) -> None:
    """List data sets: how many episodes they hold, and the digest of what they hold."""
    from mart.episodes import labels
    from mart.episodes.datasets import named
    from mart.recorder import formatting

    told = [formatting.dataset(one) for one in named(labels.read_folded(folder)).values()]
    print_result({"datasets": told}, formatting.dataset_table(told), as_json)


@datasets.command()
@_name
@_folder
@json_option
def show(name: str, folder: Path, as_json: bool) -> None:
    """Show what a data set holds, also what has been dropped, discarded or deleted since."""
    from mart.episodes import labels
    from mart.episodes.datasets import find
    from mart.episodes.filter import COUNTED
    from mart.recorder import formatting
    from mart.recorder.catalogue.episode_catalogue import list_folder

    found = find(labels.read_folded(folder), name)
    rows = {row.path: row for row in list_folder(folder)}
    unfit = {path: COUNTED.why_not(rows[path]) if path in rows else "deleted" for path in found.episodes}
    told = formatting.dataset(found) | {
        "episodes": [
            {"path": path, "left_out": why, **({"outcome": rows[path].outcome} if path in rows else {})}
            for path, why in unfit.items()
        ]
    }
    held = [rows[path] for path in found.episodes if path in rows]
    print_result(told, formatting.dataset_text(found, held, unfit), as_json)


@datasets.command()
@_name
@_paths
@filters(EpisodeOutcome.SUCCESS.value, *GOOD_VERDICTS)
@_folder
@json_option
def create(name: str, paths: tuple[Path, ...], folder: Path, as_json: bool, **wanted: Any) -> None:
    """Put episodes together under a new name: all that the filters let through, or those among PATHS."""
    from mart.episodes import labels
    from mart.episodes.datasets import named

    if name in named(labels.read_folded(folder)):
        raise Conflict(f"There is a data set {name!r} already; add to it with `mart datasets add {name}`.")
    _take_in(name, paths, folder, as_json, wanted)


@datasets.command()
@_name
@_paths
@filters(EpisodeOutcome.SUCCESS.value, *GOOD_VERDICTS)
@_folder
@json_option
def add(name: str, paths: tuple[Path, ...], folder: Path, as_json: bool, **wanted: Any) -> None:
    """Put more episodes into a data set: all that the filters let through, or those among PATHS."""
    from mart.episodes import labels
    from mart.episodes.datasets import find

    find(labels.read_folded(folder), name)
    _take_in(name, paths, folder, as_json, wanted)


@datasets.command()
@_name
@_paths
@filters()
@_folder
@json_option
def remove(name: str, paths: tuple[Path, ...], folder: Path, as_json: bool, **wanted: Any) -> None:
    """Take episodes out of a data set: those that the filters let through, or those among PATHS, there or not."""
    from mart.recorder.catalogue import dataset_editing

    if not paths and not any(value not in ("", (ANY,)) for value in wanted.values()):
        raise InvalidInput(f"Name episodes or give a filter; `mart datasets delete {name}` takes out all.")
    placed = [_placed(folder, path) for path in paths]
    left = tuple(path for path in placed if path.exists())
    chosen = _chosen(folder, left, wanted) if left or not paths else []
    names = [row.path for row in chosen] + [_below(folder, path) for path in placed if not path.exists()]
    _say(dataset_editing.take_out(folder, name, names, clock.wall_ns()), "taken out", as_json)


@datasets.command()
@_name
@_folder
@json_option
def delete(name: str, folder: Path, as_json: bool) -> None:
    """Delete a data set: every episode leaves it, and stays where it is."""
    from mart.episodes import labels
    from mart.episodes.datasets import find
    from mart.recorder.catalogue import dataset_editing

    held = find(labels.read_folded(folder), name).episodes
    _say(dataset_editing.take_out(folder, name, held, clock.wall_ns()), "taken out", as_json)


@datasets.command()
@_name
@click.argument("sources", nargs=-1, required=True)
@_folder
@click.option(
    "--allow", multiple=True, type=click.Choice(["control_hz", "versions"]), help="What may differ."
)
@json_option
def merge(
    name: str,
    sources: tuple[str, ...],
    folder: Path,
    allow: tuple[Literal["control_hz", "versions"], ...],
    as_json: bool,
) -> None:
    """Put the episodes of several data sets of one folder together under a new name; the others stay as they are.

    Their task, arms, control rate, and versions of MART and MuJoCo have to be one.
    """
    from mart.recorder.catalogue import dataset_merging
    from mart.recorder.catalogue.episode_catalogue import list_folder

    known = list_folder(folder)
    done = dataset_merging.merge(folder, name, sources, known, allowed=allow, now_ns=clock.wall_ns())
    _say(done, f"put into it, of {', '.join(sources)}", as_json)


@datasets.command()
@_name
@_folder
@json_option
def undo(name: str, folder: Path, as_json: bool) -> None:
    """Take back the last change of a data set; a second time does it again."""
    from mart.episodes import labels
    from mart.episodes.datasets import newest_act_ns
    from mart.recorder.catalogue import dataset_editing

    act_ns = newest_act_ns(labels.read(folder), name)
    _say(dataset_editing.undo(folder, name, act_ns, clock.wall_ns()), "changed back", as_json)


def _take_in(name: str, paths: tuple[Path, ...], folder: Path, as_json: bool, wanted: dict[str, Any]) -> None:
    from mart.recorder.catalogue import dataset_editing
    from mart.recorder.catalogue.episode_catalogue import list_folder

    chosen = _chosen(folder, paths, wanted)
    _say(
        dataset_editing.take_in(folder, name, chosen, list_folder(folder), now_ns=clock.wall_ns()),
        "put into it",
        as_json,
    )


def _chosen(folder: Path, paths: tuple[Path, ...], wanted: dict[str, Any]) -> list[LabelledEpisode]:
    """Choose episodes. Raises InvalidInput for a path that is not in the folder, and where nothing is let through."""
    from mart.episodes.folder import readable
    from mart.recorder.catalogue.episode_catalogue import list_paths

    placed = [_placed(folder, path) for path in paths] or [folder]
    listed = readable(list_paths(placed), placed)
    for episode in listed:
        _below(folder, episode.file_path)
    passed = filter_of(wanted, unusable=True).apply(listed)
    if not passed:
        asked = ", ".join(f"--{key} {_text(value)}" for key, value in wanted.items() if value)
        raise InvalidInput(f"None of {len(listed)} episodes is let through by {asked}; widen the filters.")
    return passed


def _text(value: str | tuple[str, ...]) -> str:
    return value if isinstance(value, str) else " or ".join(value)


def _placed(folder: Path, path: Path) -> Path:
    """Return where a path leads: it may also be given as it is listed, relative to the folder of episodes."""
    return path if path.exists() else folder / path


def _below(folder: Path, path: Path) -> str:
    """Return a path as labels name it. Raises InvalidInput where its labels are in another folder."""
    from mart.episodes import labels

    root = labels.root_of(path)
    if root != folder:
        raise InvalidInput(
            f"{path} is not labelled in {folder} but in {root}; name that folder with --folder."
        )
    return path.resolve().relative_to(root).as_posix()


def _say(done: DataSetEdit, what: str, as_json: bool) -> None:
    from mart.recorder import formatting

    print_result(*formatting.curated(done, what), as_json)
