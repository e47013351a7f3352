"""`mart train`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from pydantic import ValidationError

from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import EpisodeOutcome, OperatorKind, Verdict
from mart.runtime.cli import json_option, print_result
from mart.runtime.progress import Progress, progress
from mart.runtime.rate_option import control_hz_option, skip_idle_option
from mart.trainer.data.data_spec import DataSetName, Selection
from mart.trainer.models.architecture import model_names
from mart.trainer.train.presets import PRESETS
from mart.trainer.train.spec import TrainingSpec

if TYPE_CHECKING:
    from mart.trainer.train.progress import TrainingProgress
    from mart.trainer.train.run_directory import RunDirectory

_paths = click.Path(path_type=Path, exists=True)


@click.command()
@click.option(
    "--model", help=f"{', '.join(model_names())}, or a point PLANNER/ACTOR/RESIDUAL[/NETWORK][/HEAD]."
)
@click.option("--data", type=_paths, multiple=True, help="Episode file or folder of them; may be repeated.")
@click.option("--dataset", help="A named data set of the folder --data, whole.  [--data: data/episodes]")
@click.option(
    "--seeds",
    type=click.IntRange(1, 64),
    default=1,
    show_default=True,
    help="How many, from --first-seed on.",
)
@click.option(
    "--first-seed", type=click.IntRange(0), default=0, show_default=True, help="The smallest of them."
)
@click.option("--preset", type=click.Choice(list(PRESETS)), default="fast", show_default=True)
@click.option(
    "--set", "changes", multiple=True, metavar="NAME=VALUE", help="Change one of the preset's numbers."
)
@click.option("--out", type=click.Path(path_type=Path), help="The run's folder; one that was begun goes on.")
@click.option("--resume", type=_paths, help="Go on with this run; nothing else is asked then.")
@click.option("--base", type=_paths, help="A run, or one of its checkpoints, that a residual corrects.")
@click.option(
    "--outcome",
    type=click.Choice([*map(str, EpisodeOutcome), "any"]),
    multiple=True,
    help="[default: success]",
)
@click.option(
    "--verdict",
    type=click.Choice([*map(str, Verdict), "any"]),
    multiple=True,
    help="[default: verified and real]",
)
@click.option(
    "--operator",
    type=click.Choice([*map(str, OperatorKind)]),
    multiple=True,
    help="Only episodes driven by these.",
)
@click.option("--name", multiple=True, help="Only episodes driven by these people, skills or policies.")
@click.option("--first", type=click.IntRange(1), help="Only the oldest so many of them.")
@click.option("--last", type=click.IntRange(1), help="Only the newest so many of them.")
@click.option(
    "--weight",
    multiple=True,
    metavar="SOURCE=W",
    help="How much ticks driven by a source count, e.g. human=3.",
)
@click.option(
    "--held-out",
    default=0.0,
    show_default=True,
    type=click.FloatRange(0.0, 0.5),
    help="Share of the episodes that is measured on and not learned from.",
)
@control_hz_option
@skip_idle_option
@click.option("--device", default="cpu", show_default=True, help="cpu, cuda, cuda:N or auto.")
@json_option
def train(resume: Path | None, out: Path | None, as_json: bool, **options: Any) -> int:
    """Fit a policy to episodes."""
    from mart.runtime.service import stop_requested
    from mart.trainer.train.run_directory import RunDirectory
    from mart.trainer.train.training import train as train_run

    run = RunDirectory(_folder(resume, out))
    spec = run.spec if resume else _spec(options)
    with stop_requested() as stop, _telling(as_json=as_json) as tell:
        train_run(spec, run.path, stop, tell)
    result = {**_result(run), "complete": not stop.is_set()}
    print_result(result, _words(result), as_json)
    return 130 if stop.is_set() else 0


@contextlib.contextmanager
def _telling(*, as_json: bool) -> Iterator[Callable[[TrainingProgress], None]]:
    """Show a bar on a terminal; a line a report where standard error goes into a file."""
    with contextlib.ExitStack() as stack:
        bars: list[Progress] = []

        def tell(made: TrainingProgress) -> None:
            if not sys.stderr.isatty():
                if not as_json:
                    click.echo(_line(made), err=True)
                return
            if not bars:
                bars.append(stack.enter_context(progress("Updates", made.updates_in_all, as_json=as_json)))
            bars[0].reach(made.updates)

        yield tell


def _folder(resume: Path | None, out: Path | None) -> Path:
    if (resume is None) == (out is None):
        raise InvalidInput("Give --out DIR for a new run, or --resume DIR for one that was begun.")
    return resume or out or Path()


def _spec(options: dict[str, Any]) -> TrainingSpec:
    """Return what the options ask for. Raises InvalidInput for what cannot be asked."""
    if not options["model"] or not (options["data"] or options["dataset"]):
        raise InvalidInput("Give --model and --data or --dataset, or --resume DIR to go on with a run.")
    dataset, data, usual = _data(options["data"], options["dataset"])
    first, count = options["first_seed"], options["seeds"]
    try:
        return TrainingSpec(
            model=options["model"],
            data=data,
            dataset=dataset,
            seeds=tuple(range(first, first + count)),
            preset=options["preset"],
            changes={name: _value(text) for name, text in _pairs(options["changes"])},
            selection={
                "outcomes": _any(options["outcome"], usual.outcomes),
                "verdicts": _any(options["verdict"], usual.verdicts),
                "operators": options["operator"],
                "names": options["name"],
                "first": options["first"],
                "last": options["last"],
                "skip_idle_s": options["skip_idle_s"],
            },
            weights={name: _value(text) for name, text in _pairs(options["weight"])},
            base=options["base"].resolve() if options["base"] else None,
            device=options["device"],
            held_out=options["held_out"],
            control_hz=options["control_hz"],
        )
    except ValidationError as error:
        fault = error.errors()[0]
        where = ".".join(map(str, fault["loc"]))
        raise InvalidInput(f"{where} = {fault['input']!r} was given: {fault['msg']}; see --help.") from error


def _data(
    paths: tuple[Path, ...], name: str | None
) -> tuple[DataSetName | None, tuple[Path, ...], Selection]:
    """Return the data set, the files or folders to read, and what is taken of them where nothing is said.

    Raises Corrupt for a file that was named itself and cannot be read.
    """
    from mart.episodes.folder import described, readable
    from mart.runtime.settings import Settings
    from mart.trainer.data.named_dataset import WHOLE, find_dataset

    if not name:
        readable(described(path for path in paths if not path.is_dir()), paths)
        return None, tuple(path.resolve() for path in paths), Selection()
    if len(paths) > 1:
        raise InvalidInput(
            f"{len(paths)} times --data was given; a data set is in one folder: give that one."
        )
    return *find_dataset(paths[0] if paths else Settings().episodes_dir, name), WHOLE


def _any(given: tuple[str, ...], usual: tuple[str, ...]) -> tuple[str, ...]:
    """Return what a selection takes: `any` is no limit."""
    return () if "any" in given else given or usual


def _pairs(given: tuple[str, ...]) -> list[tuple[str, str]]:
    pairs = [tuple(text.split("=", 1)) for text in given]
    wrong = [pair[0] for pair in pairs if len(pair) != 2]
    if wrong:
        raise InvalidInput(f"{wrong[0]!r} was given; write NAME=VALUE.")
    return [(pair[0], pair[1]) for pair in pairs]


def _value(text: str) -> Any:
    """Return a number, a list or a word."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def _line(progress: TrainingProgress) -> str:
    losses = "  ".join(f"{name} {value:.4g}" for name, value in progress.losses.items())
    done = f"{progress.updates}/{progress.updates_in_all}"
    return f"{progress.phase} {done}  {progress.updates_per_s:.1f}/s  {losses}"


def _result(run: RunDirectory) -> dict[str, Any]:
    checkpointed = run.checkpointed()
    data = json.loads(run.data.read_bytes())
    return {
        "run": str(run.path),
        "model": run.spec.model_spec.name,
        "task": data["task"],
        "episodes": sum(not one.get("held_out") for one in data["episodes"]),
        "held_out": sum(one.get("held_out", False) for one in data["episodes"]),
        "ticks": data["ticks"],
        "control_hz": data["control_hz"],
        "times_seen": round(run.spec.times_seen(data["ticks"]), 1),
        "dataset": data.get("dataset"),
        "seeds": list(run.spec.seeds),
        "checkpoints": [
            str(run.checkpoint(updates, seed)) for updates in checkpointed for seed in run.seeds(updates)
        ],
    }


def _of_dataset(dataset: dict[str, Any] | None) -> str:
    if dataset is None:
        return ""
    left_out = len(dataset["left_out"])
    rest = f", {left_out} of its {dataset['episodes']} left out" if left_out else ""
    return f" of the data set {dataset['name']} ({dataset['sha256'][:12]}{rest})"


def _words(result: dict[str, Any]) -> str:
    newest = result["checkpoints"][-len(result["seeds"]) :]
    ticks = (
        f"{result['ticks']} ticks of {result['control_hz']:g} Hz, each seen {result['times_seen']:g} times"
    )
    apart = f", {result['held_out']} more held out" if result["held_out"] else ""
    learned = f"from {result['episodes']} episodes ({ticks}){apart}{_of_dataset(result['dataset'])}"
    then = "Judge them: mart eval --checkpoint" if result["complete"] else "Go on: mart train --resume"
    lines = [
        f"{result['model']} for {result['task']}, {learned}, {len(result['checkpoints'])} checkpoints",
        *newest,
        f"{then} {result['run']}",
    ]
    return "\n".join(lines)
