"""What a training is asked to do: plain data that fits a command line, a job table and a run's `run.json`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from mart.protocol.errors import InvalidInput
from mart.trainer.grid import Model
from mart.trainer.presets import Hyperparameters, preset

Operator = Literal["human", "policy", "script", "hold"]
MAX_SEEDS = 64


class Selection(BaseModel):
    """Which episodes are learned from, and how much of them. Empty: no such limit.

    operators: everybody who drove an arm of the episode is one of these (words as in an episode's operators).
    names: names of people, skills or policies, as recorded; every arm's driver must be one of them.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    outcomes: tuple[Literal["success", "failure", "discarded", "unspecified"], ...] = ("success",)
    verdicts: tuple[Literal["verified", "diverged", "unverified"], ...] = ("verified",)
    operators: tuple[Operator, ...] = ()
    names: tuple[str, ...] = ()
    first: int | None = Field(None, ge=1)  # this many episodes, the oldest
    last: int | None = Field(None, ge=1)  # the newest


class DataSetName(BaseModel):
    """A named data set and the digest of what it held when it was asked for."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    sha256: str


class TrainRequest(BaseModel):
    """One run: one model of the grid, trained with several seeds in one go on the same data.

    data: episode files, or folders of them, of one task and control rate.
    dataset: the named data set whose files `data` are.
    changes: single hyperparameters that differ from the preset's.
    weights: how much a tick counts by who drove the arm in it; 1 where it is not named, 0 leaves it out.
    base: a run whose models a residual corrects, instead of training a base first.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    model: str
    data: tuple[Path, ...] = Field(min_length=1)
    dataset: DataSetName | None = None
    seeds: tuple[int, ...] = Field((0,), min_length=1, max_length=MAX_SEEDS)
    preset: str = "fast"
    changes: Mapping[str, Any] = Field(default_factory=dict)
    selection: Selection = Selection()
    weights: Mapping[Operator, float] = Field(default_factory=dict)
    base: Path | None = None
    device: str = "cpu"

    @field_validator("seeds")
    @classmethod
    def _distinct(cls, seeds: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(seeds)) != len(seeds) or not all(0 <= seed < 2**31 for seed in seeds):
            raise ValueError("seeds must differ and lie in 0 … 2147483647")
        return seeds

    @property
    def point(self) -> Model:
        """Raises NotFound or InvalidInput where `model` names none."""
        return Model.parse(self.model)

    def times_seen(self, ticks: int) -> float:
        """How often each of so many recorded ticks is learned from, on average: what long tasks want more of."""
        sizes = self.hyperparameters
        actions = sizes.flow_chunk if self.point.network == "flow" else sizes.window
        return sizes.updates * sizes.batch_size * actions / ticks

    @property
    def hyperparameters(self) -> Hyperparameters:
        """The preset's with the changes. Raises NotFound for its name, InvalidInput for a change."""
        values = preset(self.preset).model_dump() | dict(self.changes)
        try:
            return Hyperparameters.model_validate(values)
        except ValidationError as error:
            fault = error.errors()[0]
            raise InvalidInput(
                f"The hyperparameter {fault['loc'][0]} = {fault['input']!r} was given: {fault['msg']}."
            ) from error
