"""Train a run: `mart train`, the processes of jobs and `mart.policies` call it.

The same call on a run that was begun goes on where it was: train 2 N = train N, then N, bit for bit on a CPU.
"""

from __future__ import annotations

import fcntl
import json
import math
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from mart.protocol import clock
from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import operator_from_word
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.runtime.settings import Settings
from mart.trainer.data.dataset import DataDigest, Dataset, load_dataset
from mart.trainer.data.windows import Windows
from mart.trainer.models.chunk_policy_net import ChunkPolicyNet
from mart.trainer.models.devices import find_device, product_dtype
from mart.trainer.models.networks import Networks, tool_targets, window_spec
from mart.trainer.train.metrics import MetricsWriter
from mart.trainer.train.progress import TrainingProgress
from mart.trainer.train.resume_state import read_state, write_state
from mart.trainer.train.run_checkpoints import read_base, write_checkpoint
from mart.trainer.train.run_directory import SPEC_FILE, RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training_loop import TrainingLoop, training_phases

_POINTS = 400  # of a curve
_KEPT_EVERY_S = 120.0  # what a kill may cost


def train(
    spec: TrainingSpec,
    run_dir: Path,
    stop: threading.Event,
    on_progress: Callable[[TrainingProgress], object],
) -> TrainingProgress | None:
    """Train until it is done or `stop` is set, from the newest state that `run_dir` holds.

    on_progress: called some hundred times in all, and after every checkpoint, from this thread.
    Returns the last progress that was made; None where there was nothing left to do.
    Raises InvalidInput, NotFound or Corrupt for what cannot be learned from; Conflict where the run was begun with
    another request or other data, or is being trained by another process; Unavailable where the device is missing. A
    loss that is no number any more is an InvalidInput; the checkpoints before it stay.
    """
    run = RunDirectory(run_dir)
    device = find_device(spec.device)
    with _claimed(run, spec):
        cache = Settings().data_dir / "cache" / "episodes"
        dataset = load_dataset(
            spec.data, spec.selection, cache, spec.dataset, spec.control_hz, held_out=spec.held_out
        )
        loop = _training_loop(spec, dataset, device)
        _note(run, spec, dataset)
        kept = read_state(run)
        if kept is not None:
            loop.restore(*kept)
        return _go(run, loop, lambda: _checkpoint(run, spec, dataset, loop), stop, on_progress)


def _go(
    run: RunDirectory,
    loop: TrainingLoop,
    save: Callable[[], None],
    stop: threading.Event,
    on_progress: Callable[[TrainingProgress], object],
) -> TrainingProgress | None:
    """Update until all is done or `stop` is set; `save` writes the checkpoints of now."""
    in_all, checkpoint_steps = loop.updates_in_all, loop.checkpoint_steps
    every, kept_s, progress = max(1, in_all // _POINTS), clock.monotonic_s(), None
    with MetricsWriter(run, loop.seeds, loop.updates, in_all) as metrics:
        while not loop.is_over and not stop.is_set():
            phase = loop.phase.name
            metrics.add(loop.update())
            if loop.updates not in checkpoint_steps and loop.updates % every:
                continue
            metrics.add_held_out(loop.held_out_losses())
            progress = _report(metrics, loop, phase)
            if loop.updates in checkpoint_steps:
                save()
            if loop.updates in checkpoint_steps or clock.monotonic_s() - kept_s > _KEPT_EVERY_S:
                write_state(run, loop.updates, loop.state())
                kept_s = clock.monotonic_s()
            on_progress(progress)
        if not loop.is_over:
            write_state(run, loop.updates, loop.state())
    return progress


def _training_loop(spec: TrainingSpec, dataset: Dataset, device: torch.device) -> TrainingLoop:
    sizes, model, layout = spec.hyperparameters, spec.model_spec, dataset.layout
    dtype = product_dtype(device, sizes.precision)
    networks = Networks(model, layout, sizes, spec.seeds, dtype)
    if sizes.normalise:
        networks.normaliser.fit(torch.from_numpy(dataset.observations))
    if spec.base is not None:
        if model.residual == "none":
            raise InvalidInput(f"A base was given, but {model.name} has no residual to put on it.")
        base = read_base(spec.base, spec.seeds, model, layout, dataset.digest.control_hz)
        missing, _ = networks.load_state_dict(base, strict=False)
        assert all(name.startswith("model.residual.") for name in missing)
    networks.to(device)
    phases = training_phases(networks, sizes, has_base=spec.base is not None)
    windows = _windows(spec, dataset, networks, _weights(dataset, spec), device)
    if isinstance(networks.model, ChunkPolicyNet) and networks.model.scale is not None and spec.base is None:
        networks.model.scale.fit(windows.actions())
    held_out = None if dataset.held_out is None else _windows(spec, dataset.held_out, networks, None, device)
    return TrainingLoop(networks, windows, phases, sizes, seeds=spec.seeds, dtype=dtype, held_out=held_out)


def _windows(
    spec: TrainingSpec, dataset: Dataset, networks: Networks, weights: Tensor | None, device: torch.device
) -> Windows:
    model, sizes = spec.model_spec, spec.hyperparameters
    obs = networks.normaliser(torch.from_numpy(dataset.observations).to(device))
    targets = tool_targets(model, sizes, dataset.digest.task, dataset.layout, dataset.digest.arm_kinds)
    return Windows(dataset, obs, weights, window_spec(model, sizes), device, targets=targets)


def _weights(dataset: Dataset, spec: TrainingSpec) -> Tensor | None:
    """Return float32[rows, arms]: how much a tick counts by who drove the arm in it; 1 on average."""
    if not spec.weights:
        return None
    of_source = torch.ones(int(dataset.sources.max()) + 1)
    for word, weight in spec.weights.items():
        source = operator_from_word(word)
        if source < len(of_source):
            of_source[source] = weight
    weights = of_source[torch.from_numpy(dataset.sources.astype(np.int64))]
    average = weights[torch.from_numpy(dataset.starts)].mean()
    if not average > 0:
        raise InvalidInput("The weights leave no tick to learn from; give a source of the data more than 0.")
    return weights / average


def _report(metrics: MetricsWriter, loop: TrainingLoop, phase: str) -> TrainingProgress:
    losses = metrics.write(loop.updates, phase)
    speed = losses.pop("updates_per_s")
    for name, value in losses.items():
        _require_finite(name, math.isfinite(value), loop.updates)
    return TrainingProgress(loop.updates, loop.updates_in_all, phase, speed, losses)


def _require_finite(what: str, is_finite: bool, updates: int) -> None:
    if not is_finite:
        raise InvalidInput(
            f"{what} is no number any more after {updates} updates; the checkpoints before it are good. "
            "Train anew with a smaller learning_rate."
        )


def _checkpoint(run: RunDirectory, spec: TrainingSpec, dataset: Dataset, loop: TrainingLoop) -> None:
    weights = loop.acting()
    for name, weight in weights.items():
        _require_finite(f"The weight {name}", bool(torch.isfinite(weight).all()), loop.updates)
    write_checkpoint(
        run,
        loop.updates,
        spec.seeds,
        weights,
        digest=dataset.digest,
        layout=dataset.layout,
        sizes=spec.hyperparameters,
        model=spec.model_spec,
    )


@contextmanager
def _claimed(run: RunDirectory, spec: TrainingSpec) -> Iterator[None]:
    """Let one process at a time train a run, and for one spec for ever."""
    run.path.mkdir(parents=True, exist_ok=True)
    with (run.path / "training.lock").open("ab") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise Conflict(
                f"{run.path} is being trained by another process; wait, or name another."
            ) from error
        if (run.path / SPEC_FILE).exists() and run.spec != spec:
            raise Conflict(f"{run.path} holds a run of another request; resume that one, or name another.")
        yield


def _note(run: RunDirectory, spec: TrainingSpec, dataset: Dataset) -> None:
    """Write down what is trained from what, once it is clear that it can be.

    Raises Conflict where a run had other data.
    """
    if not (run.path / SPEC_FILE).exists():
        _write_json(run.data, dataset.digest.model_dump_json())
        _write_json(run.path / SPEC_FILE, spec.model_dump_json())
    elif DataDigest.model_validate_json(run.data.read_bytes()).sha256 != dataset.digest.sha256:
        raise Conflict(
            f"The data of {run.path} have changed since it was begun; {run.data} lists what they were: "
            "put them back, or start a new run."
        )


def _write_json(path: Path, text: str) -> None:
    write_atomically(path, (json.dumps(json.loads(text), indent=2) + "\n").encode(), PUBLIC)
