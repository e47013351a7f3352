"""`mart recorder` and `mart episodes …`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mart.protocol import clock
from mart.protocol.errors import InvalidInput, Unavailable
from mart.recorder.filter_options import OUTCOMES, VERDICTS, filters, passing
from mart.recorder.settings import RecorderSettings
from mart.runtime.cli import Gathered, json_option, print_result

if TYPE_CHECKING:
    from mart.recorder.verify.resimulation import Resimulate

_path = click.argument("path", type=click.Path(path_type=Path))
_paths = click.argument("paths", nargs=-1, type=click.Path(path_type=Path))
_replica = click.option("--replica", help="Which replica re-simulates.  [default: replica-1]")


@click.command()
@click.option("--name", default="recorder-1", show_default=True, help="Id of this recorder.")
@_replica
def recorder(name: str, replica: str | None) -> None:
    """Record every episode of every room into a file of its own."""
    from mart.recorder.service import serve_recorder

    serve_recorder(_settings(replica), name)


@click.command()
@click.option("--name", default="catalogue-1", show_default=True, help="Id of this catalogue.")
def catalogue(name: str) -> None:
    """Answer what the pages ask about recorded episodes."""
    from mart.recorder.catalogue.serve import serve_catalogue

    serve_catalogue(RecorderSettings(), name)


@click.group(cls=Gathered, entry_group="mart.commands.episodes")
def episodes() -> None:
    """Work on episode files or folders of them; without a path, on all that were recorded here."""


@episodes.command("list")
@_paths
@filters()
@json_option
def list_episodes(paths: tuple[Path, ...], as_json: bool, **wanted: Any) -> None:
    """List episodes: what they are, how they ended, whether they are verified."""
    from mart.recorder import files, formatting

    rows = passing(files.rows(_given(paths)), wanted)
    print_result(
        {"episodes": [formatting.listed(path, row) for path, row in rows]}, formatting.table(rows), as_json
    )


@episodes.command()
@_path
@json_option
def show(path: Path, as_json: bool) -> None:
    """Show everything that is known about one episode."""
    from mart.episodes.reader import EpisodeFile
    from mart.recorder import files, formatting

    file = EpisodeFile.open(path)
    result = {**formatting.listed(path, files.row_of(path)), "metadata": file.strings}
    print_result(result, formatting.details(result), as_json)


@episodes.command()
@_paths
@_replica
@json_option
def verify(paths: tuple[Path, ...], replica: str | None, as_json: bool) -> int:
    """Step episodes again in a replica: do they follow bit for bit? The answer is kept as a label."""
    from mart.episodes import labels
    from mart.episodes.paths import episode_files
    from mart.episodes.reader import EpisodeFile
    from mart.protocol.vocabulary import Verdict
    from mart.recorder.verify.resimulation import verify as verify_file

    found = []
    with _resimulation(replica) as resimulate:
        for path in episode_files(_given(paths)):
            file = EpisodeFile.open(path)
            said = verify_file(file, file.room, resimulate)
            if said.verdict is not Verdict.UNVERIFIED:  # a replica that is away takes nothing back
                labels.say(path, labels.LabelKind.VERDICT, said.verdict.value, clock.wall_ns(), said.detail)
            found.append({"path": str(path), "verdict": said.verdict.value, "detail": said.detail})
    lines = [f"{entry['path']}: {entry['verdict']}. {entry['detail']}" for entry in found]
    print_result({"episodes": found}, "\n".join(lines) or "There are no episodes.", as_json)
    return 0 if all(entry["verdict"] == "verified" for entry in found) else 1


@episodes.command()
@_path
@_replica
@json_option
def replay(path: Path, replica: str | None, as_json: bool) -> int:
    """Step one episode again in a replica and report every stretch of ticks: where it agrees, where it does not."""
    from mart.episodes.reader import EpisodeFile
    from mart.recorder import formatting
    from mart.recorder.verify.resimulation import compare

    file = EpisodeFile.open(path)
    with _resimulation(replica) as resimulate:
        stretches = list(compare(file, file.room, resimulate))
    print_result(*formatting.replayed(path, stretches), as_json)
    return 1 if any(stretch.different for stretch in stretches) else 0


@episodes.command()
@click.argument("folder", required=False, type=click.Path(path_type=Path, exists=True, file_okay=False))
@_replica
@json_option
def repair(folder: Path | None, replica: str | None, as_json: bool) -> int:
    """Make episodes of what crashes have left (.part files). Files that are being recorded are left alone."""
    from mart.recorder import formatting
    from mart.recorder.repair.repair import repair_all
    from mart.recorder.verify.resimulation import verify as verify_file

    root = folder or RecorderSettings().episodes_dir
    with _resimulation(replica, wherever_possible=True) as resimulate:
        repaired = list(repair_all(root, lambda file, room: verify_file(file, room, resimulate)))
    print_result(*formatting.repaired(repaired), as_json)
    return 0 if all(one.saved for one in repaired) else 1


@episodes.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--outcome", type=click.Choice(OUTCOMES[:3]), help="How it really ended.")
@click.option("--note", help="Anything worth remembering.")
@click.option("--drop/--undrop", default=None, help="Leave out of data sets, or take in again.")
@json_option
def label(
    paths: tuple[Path, ...], outcome: str | None, note: str | None, drop: bool | None, as_json: bool
) -> None:
    """Say something about episodes. Files never change: labels are appended to labels.jsonl beside them."""
    from mart.episodes import labels
    from mart.episodes.paths import episode_files
    from mart.recorder import files, formatting

    use = None if drop is None else "drop" if drop else "keep"
    said = {labels.LabelKind.OUTCOME: outcome, labels.LabelKind.NOTE: note, labels.LabelKind.USE: use}
    if not any(value is not None for value in said.values()):
        raise InvalidInput("Nothing to say was given; use --outcome, --note, --drop or --undrop.")
    chosen = episode_files(paths)
    for path in chosen:
        for kind, value in said.items():
            if value is not None:
                labels.say(path, kind, value, clock.wall_ns())
    rows = [(path, files.row_of(path)) for path in chosen]
    print_result(
        {"episodes": [formatting.listed(path, row) for path, row in rows]}, formatting.table(rows), as_json
    )


@episodes.command()
@_paths
@click.option(
    "--format",
    "file_format",
    type=click.Choice(["robomimic", "lerobot"]),
    required=True,
    help="Whose data set it is.",
)
@click.option(
    "--out", type=click.Path(path_type=Path), required=True, help="The file or folder to be written."
)
@click.option("--outcome", type=click.Choice([*OUTCOMES, "any"]), multiple=True, help="[default: success]")
@click.option("--verdict", type=click.Choice([*VERDICTS, "any"]), multiple=True, help="[default: verified]")
@click.option("--dataset", default="", help="Only of this data set.")
@json_option
def export(paths: tuple[Path, ...], out: Path, as_json: bool, **wanted: Any) -> None:
    """Write episodes of one task as a data set of another project; dropped ones are left out."""
    from mart.recorder import files
    from mart.recorder.export.selection import choose

    if wanted["file_format"] == "robomimic":
        from mart.recorder.export.robomimic import write_robomimic as write
    else:
        from mart.recorder.export.lerobot import write_lerobot as write

    rows = [one for one in files.rows(_given(paths)) if wanted["dataset"] in ("", *one[1].datasets)]
    choice = choose(rows, _any(wanted["outcome"], "success"), _any(wanted["verdict"], "verified"))
    ticks = write(choice, out)
    count, task = len(choice.episodes), choice.task.name
    result = {
        "path": str(out),
        "format": wanted["file_format"],
        "task": task,
        "episodes": count,
        "ticks": ticks,
    }
    print_result(result, f"{out}: {count} of {len(rows)} episodes of {task}, {ticks} ticks.", as_json)


def _any(given: tuple[str, ...], usual: str) -> tuple[str, ...]:
    """What a choice takes; empty where any will do."""
    return () if "any" in given else given or (usual,)


def _settings(replica: str | None) -> RecorderSettings:
    return RecorderSettings() if replica is None else RecorderSettings(replica=replica)


def _given(paths: tuple[Path, ...]) -> tuple[Path, ...]:
    default = RecorderSettings().episodes_dir
    return paths or ((default,) if default.exists() else ())


@contextmanager
def _resimulation(replica: str | None, *, wherever_possible: bool = False) -> Iterator[Resimulate]:
    """Asks a replica. Without a router it raises Unavailable: at once, or `wherever_possible` only when asked."""
    from mart.recorder.verify import resimulation as verification
    from mart.runtime.bus.zenoh_bus import ZenohBus

    settings = _settings(replica)
    try:
        bus = ZenohBus.connect(settings.router, wait_for_router=False)
    except Unavailable as error:
        if not wherever_possible:
            raise
        yield verification.nobody(error)
    else:
        with bus:
            yield verification.replica(bus, settings.replica)
