"""Run `mart recorder`, `mart catalogue` and `mart episodes …`.

Heavy modules are imported inside: `mart --help` loads this file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import GOOD_VERDICTS
from mart.recorder.edit_cli import edit
from mart.recorder.export_cli import export
from mart.recorder.filter_options import LABELS, filter_of, filters
from mart.recorder.import_cli import import_
from mart.recorder.replay_cli import replay
from mart.recorder.replica_option import recorder_settings, replica_option, resimulation
from mart.recorder.settings import RecorderSettings, given_or_recorded
from mart.recorder.storage_cli import pull, push
from mart.runtime.cli import Gathered, json_option, print_result
from mart.runtime.progress import progress, tracked

_path = click.argument("path", type=click.Path(path_type=Path))
_paths = click.argument("paths", nargs=-1, type=click.Path(path_type=Path))


@click.command()
@click.option("--name", default="recorder-1", show_default=True, help="Id of this recorder.")
@replica_option
def recorder(name: str, replica: str | None) -> None:
    """Record every episode of every room into a file of its own."""
    from mart.recorder.service import serve_recorder

    serve_recorder(recorder_settings(replica), name)


@click.command()
@click.option("--name", default="catalogue-1", show_default=True, help="Id of this catalogue.")
def catalogue(name: str) -> None:
    """Answer what the pages ask about recorded episodes."""
    from mart.recorder.catalogue.serve import serve_catalogue

    serve_catalogue(RecorderSettings(), name)


@click.group(cls=Gathered, entry_group="mart.commands.episodes")
def episodes() -> None:
    """Work on episode files or folders of them; without a path, on all that were recorded here."""


for _command in (edit, export, import_, pull, push, replay):
    episodes.add_command(_command)


@episodes.command("list")
@_paths
@filters()
@json_option
def list_episodes(paths: tuple[Path, ...], as_json: bool, **wanted: Any) -> None:
    """List episodes: what they are, how they ended, whether they are verified."""
    from mart.recorder import formatting
    from mart.recorder.catalogue.episode_catalogue import list_paths

    listed = filter_of(wanted, unusable=True).apply(list_paths(given_or_recorded(paths)))
    print_result({"episodes": [*map(formatting.listed, listed)]}, formatting.table(listed), as_json)


@episodes.command()
@_path
@json_option
def show(path: Path, as_json: bool) -> None:
    """Show everything that is known about one episode."""
    from mart.episodes.folder import described
    from mart.episodes.reader import open_episode
    from mart.recorder import formatting

    file = open_episode(path)
    (listed,) = described([path])
    whole = {"model": formatting.model(file), "pictures": formatting.pictures(file, listed.arms)}
    result = {**formatting.listed(listed), **whole, "metadata": file.metadata}
    print_result(result, formatting.details(result), as_json)


@episodes.command()
@_paths
@replica_option
@json_option
def verify(paths: tuple[Path, ...], replica: str | None, as_json: bool) -> int:
    """Step episodes again in a replica: do their states follow from their actions bit for bit?

    The answer is kept as a label. It covers states and actions; what else a file says is not part of it.
    """
    from mart.episodes.folder import described, episode_files, readable
    from mart.recorder import formatting
    from mart.recorder.verify.resimulation import verify as verify_file
    from mart.recorder.verify.verdict_label import keep_verdict

    found: list[dict[str, Any]] = []
    listed = described(episode_files(given_or_recorded(paths)))
    with resimulation(replica) as ask:
        for one in tracked(readable(listed, paths), "Verified", as_json=as_json):
            file = one.open()
            said = verify_file(file, file.room, ask)
            keep_verdict(one.file_path, said, clock.wall_ns())
            found.append(formatting.verified(one.file_path, said))
            if not as_json:  # at once: what has been labelled is told whatever comes later
                click.echo("{path}: {verdict}. {detail}".format(**found[-1]))
    left_out = [{"path": str(one.file_path), "why": one.error} for one in listed if one.error is not None]
    if as_json or not found:
        print_result({"episodes": found, "left_out": left_out}, "There are no episodes.", as_json)
    damaged = any(one.error is not None and not (one.foreign or one.dropped) for one in listed)
    return 1 if damaged or any(entry["verdict"] not in GOOD_VERDICTS for entry in found) else 0


@episodes.command()
@_paths
@json_option
def check(paths: tuple[Path, ...], as_json: bool) -> int:
    """Read episodes whole, without a replica: is every byte sound, and are all ticks and commands there?"""
    from mart.episodes.folder import episode_files
    from mart.recorder import formatting
    from mart.recorder.verify.file_check import check_file

    found = [check_file(path) for path in episode_files(given_or_recorded(paths))]
    print_result(*formatting.checked(found), as_json)
    return 0 if all(one.is_whole for one in found) else 1


@episodes.command()
@_paths
@replica_option
@json_option
def repair(paths: tuple[Path, ...], replica: str | None, as_json: bool) -> int:
    """Make episodes of what crashes have left (.part files), and of damaged files new ones beside them.

    Finished files never change, and what is being recorded, or is not MART's, is left alone.
    """
    from mart.recorder import formatting
    from mart.recorder.repair.repair import file_count, repair_paths
    from mart.recorder.verify.resimulation import verify as verify_file

    given = given_or_recorded(paths)
    with (
        resimulation(replica, wherever_possible=True) as ask,
        progress("Files", file_count(given), as_json=as_json) as shown,
    ):
        mended = repair_paths(given, lambda file, room: verify_file(file, room, ask), shown.advance)
        repaired = list(mended)
    print_result(*formatting.repaired(repaired), as_json)
    return 0 if all(one.saved or one.needless for one in repaired) else 1


@episodes.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--outcome", type=click.Choice(LABELS), help="How it really ended.")
@click.option("--note", help="Anything worth remembering.")
@click.option("--drop/--undrop", default=None, help="Leave out of data sets, or take in again.")
@json_option
def label(
    paths: tuple[Path, ...], outcome: str | None, note: str | None, drop: bool | None, as_json: bool
) -> None:
    """Say something about episodes. Files never change: labels are appended to labels.jsonl beside them."""
    from mart.episodes import labels
    from mart.episodes.folder import described, episode_files
    from mart.recorder import formatting

    use = None if drop is None else labels.DROP if drop else labels.KEEP
    said = {labels.LabelKind.OUTCOME: outcome, labels.LabelKind.NOTE: note, labels.LabelKind.USE: use}
    if not any(value is not None for value in said.values()):
        raise InvalidInput("Nothing to say was given; use --outcome, --note, --drop or --undrop.")
    chosen = episode_files(paths)
    for path in chosen:
        for kind, value in said.items():
            if value is not None:
                labels.say(path, kind, value, clock.wall_ns())
    listed = described(chosen)
    print_result({"episodes": [*map(formatting.listed, listed)]}, formatting.table(listed), as_json)
