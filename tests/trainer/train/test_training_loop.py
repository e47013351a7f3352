"""How large the steps of a training are as it goes on."""

from __future__ import annotations

import pytest

from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.train.training_loop import learning_rate


def test_with_a_cosine_the_rate_falls_from_all_of_it_to_nothing() -> None:
    sizes = Hyperparameters(learning_rate=1e-3, schedule="cosine")
    rates = [learning_rate(sizes, part) for part in (0.0, 1 / 3, 0.5, 1.0)]
    assert rates == pytest.approx([1e-3, 0.75e-3, 0.5e-3, 0.0])


def test_a_constant_rate_stays() -> None:
    sizes = Hyperparameters(learning_rate=1e-3, schedule="constant")
    assert {learning_rate(sizes, part) for part in (0.0, 0.5, 1.0)} == {1e-3}
