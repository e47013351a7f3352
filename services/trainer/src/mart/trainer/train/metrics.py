"""Curves of a training: `metrics.jsonl`, one line a point, and the same for TensorBoard, seed by seed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from torch import Tensor
from torch.utils.tensorboard import SummaryWriter

from mart.protocol import clock
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.runtime.json_lines import read_json_lines
from mart.trainer.models.losses import Losses
from mart.trainer.train.run_directory import RunDirectory


class MetricsWriter:
    """Write means over the updates since the last line.

    A line: updates, updates_in_all, updates_per_s, stage, at_ns, loss, loss/NAME of its parts, other diagnostics,
    held_out/NAME of the parts where episodes are held out.
    """

    def __init__(self, run: RunDirectory, seeds: tuple[int, ...], updates: int, updates_in_all: int) -> None:
        """Go on after `updates` updates; what was written of later ones is forgotten, for they are made again."""
        _forget_after(run, updates)
        self._file = run.metrics.open("a", encoding="utf-8")
        self._board = SummaryWriter(str(run.tensorboard), purge_step=updates + 1)
        self._seeds, self._in_all = seeds, updates_in_all
        self._last, self._last_s = updates, clock.monotonic_s()
        self._sums: dict[str, Tensor] = {}
        self._counts: dict[str, int] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._board.close()

    def add(self, losses: Losses) -> None:
        """Add the losses of one update; the device is not waited for."""
        named = {f"loss/{name}": loss.detach() for name, loss in losses.terms.items()} | losses.diagnostics
        for name, value in named.items():
            self._sums[name] = self._sums[name] + value if name in self._sums else value
            self._counts[name] = self._counts.get(name, 0) + 1

    def add_held_out(self, losses: Losses | None) -> None:
        """Add the losses on episodes that are not learned from, as `held_out/NAME`; None adds nothing."""
        if losses is not None:
            held_out = {f"held_out/{name}": loss.detach() for name, loss in losses.terms.items()}
            self.add(Losses({}, held_out))

    def write(self, updates: int, phase: str) -> dict[str, float]:
        """Write a line and return its numbers, whose losses may not be finite: the caller looks."""
        now_s = clock.monotonic_s()
        by_seed = {
            name: (total / self._counts[name]).reshape(len(self._seeds), -1).mean(1).cpu()
            for name, total in self._sums.items()
        }
        means = {name: float(values.mean()) for name, values in by_seed.items()}
        means["loss"] = sum(value for name, value in means.items() if name.startswith("loss/"))
        speed = (updates - self._last) / max(now_s - self._last_s, 1e-9)
        line = {
            "updates": updates,
            "updates_in_all": self._in_all,
            "updates_per_s": round(speed, 3),
            "stage": phase,
            "at_ns": clock.wall_ns(),
        }
        self._file.write(json.dumps(line | means) + "\n")
        self._file.flush()
        self._show(updates, by_seed, speed)
        self._sums, self._counts, self._last, self._last_s = {}, {}, updates, now_s
        return means | {"updates_per_s": speed}

    def _show(self, updates: int, by_seed: Mapping[str, Tensor], speed: float) -> None:
        for name, values in by_seed.items():
            for seed, value in zip(self._seeds, values.tolist(), strict=True):
                self._board.add_scalar(f"{name}/seed-{seed}", value, updates)
        self._board.add_scalar("updates_per_s", speed, updates)
        self._board.flush()


def _forget_after(run: RunDirectory, updates: int) -> None:
    """Remove the lines of later updates, and one that a kill has torn: they are made again."""
    if run.metrics.exists():
        rows = (
            row for _, row in read_json_lines(run.metrics) if row is not None and row["updates"] <= updates
        )
        kept = "".join(json.dumps(row) + "\n" for row in rows)
        write_atomically(run.metrics, kept.encode(), PUBLIC)


def read_held_out(path: Path) -> list[tuple[int, float]]:
    """Return (updates, loss on held-out episodes, its parts added) of the base, from a run's `metrics.jsonl`."""
    points = []
    for _, row in read_json_lines(path):
        held_out = [value for name, value in (row or {}).items() if name.startswith("held_out/")]
        if row is not None and held_out and row["stage"] == "base":
            points.append((int(row["updates"]), float(sum(held_out))))
    return points
