"""The directory of a run.

run.json                      what was asked (TrainingSpec)
data.json                     what was used: files, hashes, counts, outcomes, operators
metrics.jsonl, tensorboard/   curves
checkpoints/4000/seed-0/      after 4000 updates, one checkpoint a seed
resume/4000/                  what an exact continuation needs besides; the newest only
evaluations.jsonl             what rollouts said
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mart.protocol.errors import Corrupt, NotFound
from mart.trainer.models.checkpoint import RECORD
from mart.trainer.train.spec import TrainingSpec

SPEC_FILE = "run.json"


@dataclass(frozen=True)
class RunDirectory:
    """The folder of one run, and where its files are."""

    path: Path

    @property
    def spec(self) -> TrainingSpec:
        """What the run was asked to do.

        Raises NotFound where this is no run and Corrupt where what it was asked cannot be read.
        """
        file = self.path / SPEC_FILE
        if not file.is_file():
            raise NotFound(f"There is no run {self.path}; name a directory that holds {SPEC_FILE}.")
        try:
            return TrainingSpec.model_validate_json(file.read_bytes())
        except ValueError as error:
            raise Corrupt(f"{file} cannot be read; start a new run.") from error

    @property
    def data(self) -> Path:
        """What was learned from."""
        return self.path / "data.json"

    @property
    def metrics(self) -> Path:
        """The curves, as lines of JSON."""
        return self.path / "metrics.jsonl"

    @property
    def tensorboard(self) -> Path:
        """The curves, for TensorBoard."""
        return self.path / "tensorboard"

    @property
    def evaluations(self) -> Path:
        """What evaluations said, as lines of JSON."""
        return self.path / "evaluations.jsonl"

    @property
    def checkpoints(self) -> Path:
        """The folder of all checkpoints."""
        return self.path / "checkpoints"

    @property
    def resume(self) -> Path:
        """The folder of what a continuation needs."""
        return self.path / "resume"

    def checkpointed(self) -> tuple[int, ...]:
        """Return after how many updates there are checkpoints, rising."""
        return tuple(sorted(int(path.name) for path in self.checkpoints.glob("*") if path.name.isdigit()))

    def seeds(self, updates: int) -> tuple[int, ...]:
        """Return which seeds have a checkpoint after so many updates."""
        found = (self.checkpoints / str(updates)).glob(f"seed-*/{RECORD}")
        return tuple(sorted(int(path.parent.name.removeprefix("seed-")) for path in found))

    def checkpoint(self, updates: int, seed: int) -> Path:
        """Return the folder of a checkpoint: what `load_policy` takes."""
        return self.checkpoints / str(updates) / f"seed-{seed}"
