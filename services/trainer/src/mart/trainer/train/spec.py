"""What a training is asked to do: plain data that fits a command line, a job table and a run's `run.json`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from mart.protocol.control_rate import MAX_CONTROL_HZ, MIN_CONTROL_HZ
from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import OperatorKind
from mart.trainer.data.data_spec import DataSetName, Selection
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.train.presets import preset

MAX_SEEDS = 64


class TrainingSpec(BaseModel):
    """What one run is asked to do: one model of the grid, trained with several seeds in one go on the same data.

    data: episode files, or folders of them, of one task.
    dataset: the named data set whose files `data` are.
    changes: single hyperparameters that differ from the preset's.
    weights: how much a tick counts by who drove the arm in it; 1 where it is not named, 0 leaves it out.
    base: a run whose models a residual corrects, instead of training a base first.
    held_out: share of the episodes that is not learned from, only measured on while training.
    control_hz: the rate to learn at, at most that of every episode; None: the one rate that all of them have.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    model: str
    data: tuple[Path, ...] = Field(min_length=1)
    dataset: DataSetName | None = None
    seeds: tuple[int, ...] = Field((0,), min_length=1, max_length=MAX_SEEDS)
    preset: str = "fast"
    changes: Mapping[str, Any] = Field(default_factory=dict)
    selection: Selection = Selection()
    weights: Mapping[OperatorKind, float] = Field(default_factory=dict)
    base: Path | None = None
    device: str = "cpu"
    held_out: float = Field(0.0, ge=0.0, le=0.5)
    control_hz: float | None = Field(None, ge=MIN_CONTROL_HZ, le=MAX_CONTROL_HZ)

    @field_validator("seeds")
    @classmethod
    def _distinct(cls, seeds: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(seeds)) != len(seeds) or not all(0 <= seed < 2**31 for seed in seeds):
            raise ValueError("seeds must differ and lie in 0 … 2147483647")
        return seeds

    @property
    def model_spec(self) -> ModelSpec:
        """The model as a point of the grid. Raises NotFound or InvalidInput where `model` names none."""
        return ModelSpec.parse(self.model)

    def times_seen(self, ticks: int) -> float:
        """Return how often each of so many recorded ticks is learned from, on average: what long tasks want more of."""
        sizes = self.hyperparameters
        actions = sizes.chunk if self.model_spec.is_chunked else sizes.window
        return sizes.updates * sizes.batch_size * actions / ticks

    @property
    def hyperparameters(self) -> Hyperparameters:
        """The preset's with the changes. Raises NotFound for its name, InvalidInput for a change."""
        values = preset(self.preset).model_dump() | dict(self.changes)
        try:
            sizes = Hyperparameters.model_validate(values)
        except ValidationError as error:
            fault = error.errors()[0]
            raise InvalidInput(
                f"The hyperparameter {fault['loc'][0]} = {fault['input']!r} was given: {fault['msg']}."
            ) from error
        model = self.model_spec
        if sizes.one_arm_share > 0 and (model.is_chunked or model.head != "l2"):
            raise InvalidInput(
                f"one_arm_share = {sizes.one_arm_share:g} was given, but {model.name} learns all arms' actions "
                "as one; leave it 0, or use a model that ends in the mean action, such as BC-RNN or HBC."
            )
        return sizes
