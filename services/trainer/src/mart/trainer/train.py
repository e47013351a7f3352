"""Training as a function: `mart train` and the executors of jobs call it.

The same call on a run that was begun goes on where it was: train 2 N = train N, then N, bit for bit on a CPU.
"""

from __future__ import annotations

import fcntl
import math
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from mart.protocol import clock
from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import operator_from_word
from mart.runtime.settings import Settings
from mart.trainer import keep
from mart.trainer.course import Course, stages
from mart.trainer.data.dataset import Dataset, Digest, load_dataset
from mart.trainer.data.windows import Windows
from mart.trainer.devices import find_device, product_dtype
from mart.trainer.metrics import Metrics
from mart.trainer.nets.build import Networks, window_shape
from mart.trainer.request import TrainRequest
from mart.trainer.runs import REQUEST, RunDirectory

_POINTS = 400  # of a curve
_KEPT_EVERY_S = 120.0  # what a kill may cost


@dataclass(frozen=True)
class Progress:
    """`losses`: by name, means over seeds since the last report."""

    updates: int
    updates_in_all: int
    stage: str
    updates_per_s: float
    losses: Mapping[str, float]


def train(
    request: TrainRequest,
    run_dir: Path,
    stop: threading.Event,
    on_progress: Callable[[Progress], object],
) -> Progress | None:
    """Trains until it is done or `stop` is set, from the newest state that `run_dir` holds.

    on_progress: called some hundred times in all, and after every checkpoint, from this thread.
    Returns the last progress that was made; None where there was nothing left to do.
    Raises InvalidInput, NotFound or Corrupt for what cannot be learned from; Conflict where the run was begun with
    another request or other data, or is being trained by another process; Unavailable where the device is missing. A
    loss that is no number any more is an InvalidInput; the checkpoints before it stay.
    """
    run = RunDirectory(run_dir)
    device = find_device(request.device)
    with _claimed(run, request):
        cache = Settings().data_dir / "cache" / "episodes"
        dataset = load_dataset(request.data, request.selection, cache, request.dataset)
        course = _course(request, dataset, device)
        _note(run, request, dataset)
        kept = keep.read_state(run)
        if kept is not None:
            course.restore(*kept)
        return _go(run, course, lambda: _checkpoint(run, request, dataset, course), stop, on_progress)


def _go(
    run: RunDirectory,
    course: Course,
    save: Callable[[], None],
    stop: threading.Event,
    on_progress: Callable[[Progress], object],
) -> Progress | None:
    """`save` writes the checkpoints of now."""
    in_all, marks = course.updates_in_all, course.marks
    every, kept_s, progress = max(1, in_all // _POINTS), clock.monotonic_s(), None
    with Metrics(run, course.seeds, course.updates, in_all) as metrics:
        while not course.is_over and not stop.is_set():
            stage = course.stage.name
            metrics.add(course.update())
            if course.updates not in marks and course.updates % every:
                continue
            progress = _report(metrics, course, stage)
            if course.updates in marks:
                save()
            if course.updates in marks or clock.monotonic_s() - kept_s > _KEPT_EVERY_S:
                keep.write_state(run, course.updates, course.state())
                kept_s = clock.monotonic_s()
            on_progress(progress)
        if not course.is_over:
            keep.write_state(run, course.updates, course.state())
    return progress


def _course(request: TrainRequest, dataset: Dataset, device: torch.device) -> Course:
    sizes, model, layout = request.hyperparameters, request.point, dataset.layout
    dtype = product_dtype(device, sizes.precision)
    networks = Networks(model, layout, sizes, request.seeds, dtype)
    if sizes.normalise:
        networks.normaliser.fit(dataset)
    if request.base is not None:
        if model.residual == "none":
            raise InvalidInput(f"A base was given, but {model.name} has no residual to put on it.")
        base = keep.read_base(request.base, request.seeds, model, layout)
        missing, _ = networks.load_state_dict(base, strict=False)
        assert all(name.startswith("model.residual.") for name in missing)
    networks.to(device)
    seen = networks.normaliser(torch.from_numpy(dataset.observations).to(device))
    shape = window_shape(model, sizes)
    windows = Windows(dataset, seen, _weights(dataset, request), shape, device)
    course_stages = stages(networks, sizes, has_base=request.base is not None)
    return Course(networks, windows, course_stages, sizes, seeds=request.seeds, dtype=dtype)


def _weights(dataset: Dataset, request: TrainRequest) -> Tensor | None:
    """float32[rows, arms] by who drove the arm in the tick; 1 on average over the ticks."""
    if not request.weights:
        return None
    of_source = torch.ones(int(dataset.sources.max()) + 1)
    for word, weight in request.weights.items():
        source = operator_from_word(word)
        if source < len(of_source):
            of_source[source] = weight
    weights = of_source[torch.from_numpy(dataset.sources.astype(np.int64))]
    average = weights[torch.from_numpy(dataset.starts)].mean()
    if not average > 0:
        raise InvalidInput("The weights leave no tick to learn from; give a source of the data more than 0.")
    return weights / average


def _report(metrics: Metrics, course: Course, stage: str) -> Progress:
    losses = metrics.write(course.updates, stage)
    speed = losses.pop("updates_per_s")
    for name, value in losses.items():
        _require_finite(name, math.isfinite(value), course.updates)
    return Progress(course.updates, course.updates_in_all, stage, speed, losses)


def _require_finite(what: str, is_finite: bool, updates: int) -> None:
    if not is_finite:
        raise InvalidInput(
            f"{what} is no number any more after {updates} updates; the checkpoints before it are good. "
            "Train anew with a smaller learning_rate."
        )


def _checkpoint(run: RunDirectory, request: TrainRequest, dataset: Dataset, course: Course) -> None:
    weights = course.acting()
    for name, weight in weights.items():
        _require_finite(f"The weight {name}", bool(torch.isfinite(weight).all()), course.updates)
    keep.write_checkpoint(
        run,
        course.updates,
        request.seeds,
        weights,
        digest=dataset.digest,
        layout=dataset.layout,
        sizes=request.hyperparameters,
        model=request.point,
    )


@contextmanager
def _claimed(run: RunDirectory, request: TrainRequest) -> Iterator[None]:
    """One process at a time, and one request for ever."""
    run.path.mkdir(parents=True, exist_ok=True)
    with (run.path / "training.lock").open("ab") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise Conflict(
                f"{run.path} is being trained by another process; wait, or name another."
            ) from error
        if (run.path / REQUEST).exists() and run.request != request:
            raise Conflict(f"{run.path} holds a run of another request; resume that one, or name another.")
        yield


def _note(run: RunDirectory, request: TrainRequest, dataset: Dataset) -> None:
    """What is trained from what: once it is clear that it can be. Raises Conflict where a run had other data."""
    if not (run.path / REQUEST).exists():
        keep.write_json(run.data, dataset.digest.model_dump_json())
        keep.write_json(run.path / REQUEST, request.model_dump_json())
    elif Digest.model_validate_json(run.data.read_bytes()).sha256 != dataset.digest.sha256:
        raise Conflict(
            f"The data of {run.path} have changed since it was begun; {run.data} lists what they were: "
            "put them back, or start a new run."
        )
