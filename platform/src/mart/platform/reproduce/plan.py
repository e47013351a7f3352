"""Which steps a reproduction takes: options in, steps out. Pure.

Each step is one command of `mart` with a result that is a file or a folder, and is named after it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.platform.reproduce.sizes import (
    BASES,
    COLLECTION_SEED,
    EPISODES_AT_ONCE,
    MIXED_TASKS,
    PRESETS,
    TABLE_MODELS,
    TABLE_TASKS,
    Sizes,
    groups_of,
)
from mart.protocol.errors import InvalidInput, NotFound
from mart.runtime.step_record import PlannedStep


@dataclass(frozen=True)
class ReproductionOptions:
    """What to reproduce. Empty tasks or models, and None: what the table and the preset have.

    data: a folder with a folder of episodes for each task, in place of collecting; then there is no table 3, whose
    data are the user study's.
    """

    tables: tuple[str, ...]
    preset: str
    tasks: tuple[str, ...] = ()
    models: tuple[str, ...] = ()
    seeds: int | None = None
    episodes: int | None = None
    data: Path | None = None
    changes: tuple[str, ...] = ()

    @property
    def sizes(self) -> Sizes:
        """The preset's numbers."""
        return PRESETS[self.preset]


@dataclass(frozen=True)
class _Data:
    """Episodes that are learned from: `folder` is made by the steps `made_by`."""

    folder: str
    made_by: tuple[str, ...]


def steps_of(options: ReproductionOptions) -> tuple[PlannedStep, ...]:
    """Return the steps in an order in which each comes after those that it needs.

    Raises NotFound for a task or model that no table has, InvalidInput where nothing is left to do.
    """
    _require_known("task", options.tasks, {task for own in TABLE_TASKS.values() for task in own})
    _require_known("model", options.models, {model for own in TABLE_MODELS.values() for model in own})
    found = {step.name: step for table in options.tables for step in _table(options, table)}
    if not found:
        raise InvalidInput(
            f"{', '.join(options.tables)} has none of the tasks or models that were given: "
            f"{', '.join((*options.tasks, *options.models)) or 'none'}; see docs/how-to-reproduce-the-paper.md."
        )
    return tuple(found.values())


def _require_known(what: str, given: Sequence[str], known: set[str]) -> None:
    for name in given:
        if name not in known:
            raise NotFound.named(what, name, sorted(known))


def _table(options: ReproductionOptions, table: str) -> Iterator[PlannedStep]:
    tasks = [task for task in TABLE_TASKS[table] if not options.tasks or task in options.tasks]
    for task in tasks:
        if table == "table1":
            yield from _coordination(options, task)
        else:
            study = table == "table3"
            models = [m for m in TABLE_MODELS[table] if not options.models or m in options.models]
            if models:
                collected = list(_collect(options, task, study=study))
                yield from collected
                data = _data(options, task, collected, study=study)
                yield from _cells(options, table, task, models, data)


def _coordination(options: ReproductionOptions, task: str) -> Iterator[PlannedStep]:
    for study in (False,) if options.data else (False, True):
        collected = list(_collect(options, task, study=study))
        yield from collected
        data = _data(options, task, collected, study=study)
        name = f"table1/{task}-{'study' if study else 'experienced'}"
        yield PlannedStep(
            name=name,
            kind="table",
            command=("report", "coordination", data.folder, "--json"),
            inputs=(data.folder,),
            result=f"{name}.json",
            after=data.made_by,
            table="table1",
            task=task,
            stdout=True,
        )


def _collect(options: ReproductionOptions, task: str, *, study: bool) -> Iterator[PlannedStep]:
    """Collect in batches: experienced operators by the number, the study's people group by group."""
    if options.data is not None and not study:
        return
    sizes, count = options.sizes, options.episodes or options.sizes.episodes
    if study:
        groups = groups_of(task)
        batches = [(group.name, group.people, math.ceil(count / len(groups))) for group in groups]
    else:
        batches = [
            (f"batch-{number + 1:02}", sizes.skill, min(EPISODES_AT_ONCE, count - number * EPISODES_AT_ONCE))
            for number in range(math.ceil(count / EPISODES_AT_ONCE))
        ]
    for number, (name, people, episodes) in enumerate(batches):
        folder = f"{_folder(task, study=study)}/{name}"
        seed = COLLECTION_SEED + number + (100 if study else 0)
        yield PlannedStep(
            name=folder,
            kind="collect",
            command=(
                *("collect", "--lockstep", "--task", task, "--episodes", str(episodes), "--skill", people),
                *("--seed", str(seed), "--out", folder, "--json"),
            ),
            result=folder,
            task=task,
            seeds=(seed,),
        )


def _folder(task: str, *, study: bool) -> str:
    return f"data/{'study' if study else 'experienced'}/{task}"


def _data(options: ReproductionOptions, task: str, collected: Sequence[PlannedStep], *, study: bool) -> _Data:
    if options.data is not None and not study:
        return _Data(str(options.data / task), ())
    return _Data(_folder(task, study=study), tuple(step.name for step in collected))


def _cells(
    options: ReproductionOptions, table: str, task: str, models: Sequence[str], data: _Data
) -> Iterator[PlannedStep]:
    """Train and judge; the base of a residual is trained also where it was not asked for."""
    needed = [model for model in TABLE_MODELS[table] if model in {*models, *map(BASES.get, models)}]
    for model in needed:
        run = f"runs/{table}/{task}/{model}"
        yield _training(options, table, task, model, data)
        if model in models:
            sizes = options.sizes
            yield PlannedStep(
                name=f"judged/{table}/{task}/{model}",
                kind="eval",
                command=(
                    *("eval", "--checkpoint", run, "--episodes", str(sizes.judged)),
                    *("--score-episodes", str(sizes.scored), "--seed", "0", "--json"),
                ),
                inputs=(run,),
                result=f"{run}/evaluations.jsonl",
                after=(run,),
                table=table,
                task=task,
                model=model,
                seeds=(0,),
            )


def _training(options: ReproductionOptions, table: str, task: str, model: str, data: _Data) -> PlannedStep:
    run, base = f"runs/{table}/{task}/{model}", BASES.get(model)
    base_run = f"runs/{table}/{task}/{base}" if base else ""
    sizes, seeds = options.sizes, options.seeds or options.sizes.seeds
    return PlannedStep(
        name=run,
        kind="train",
        command=(
            *("train", "--model", model, "--data", data.folder, "--seeds", str(seeds), *sizes.train),
            *(sizes.long if task in MIXED_TASKS else ()),
            *("--held-out", f"{sizes.held_out:g}"),
            *(word for change in options.changes for word in ("--set", change)),
            *(("--base", base_run) if base else ()),
            *("--out", run, "--json"),
        ),
        inputs=(data.folder, *((base_run,) if base else ())),
        result=run,
        after=(*data.made_by, *((base_run,) if base else ())),
        table=table,
        task=task,
        model=model,
        seeds=tuple(range(seeds)),
    )
