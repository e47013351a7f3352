"""How much each arm's next action depends on the other arms, over the course of an episode.

The paper's insight (section "Learning Mixed Coordination"): most tasks need coordination only now and then. Here that
is measured on held-out episodes. Arm i's action is predicted twice from all observations: once as recorded, and once
with what only the others see taken from another episode at the same share of its length, in training and in testing
alike. Both predictors have the same size and know the time; the second one knows nothing about the partners. What the
first one does better is what the partners' states say about the action:

    dependence = 1 - E|a - f(own, others)|² / E|a - f(own, others of another episode)|²

0: the arm works for itself. Below 0: looking at the others costs more, by overfitting, than it tells.
The predictor is ridge regression on random ReLU features (Rahimi and Recht, "Weighted Sums of Random Kitchen Sinks",
NIPS 2008): closed form, so that nothing has to be tuned or trained for long.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput

Array = NDArray[np.float64]

BINS = 10
_FOLDS = 5
_FEATURES = 256
_RIDGE = 0.1  # of the number of samples; 0.0001 to 0.01 do worse on held-out episodes of two tasks
_SMALLEST_SCALE = 0.01  # of a column: what moves less (a cube that rests) must not be blown up
_LARGEST = 3.0  # standard deviations; beyond, a held-out episode would be extrapolated
_RESAMPLES = 200
_CLOCK_TICKS = 100  # of the time, to be of the order of 1
MIN_EPISODES = 2 * _FOLDS


@dataclass(frozen=True)
class ObservedEpisode:
    """One episode: observations [T, width] before each action, actions [T, arms, 7]."""

    observations: Array
    actions: Array

    @property
    def bins(self) -> NDArray[np.int64]:
        """Return int64[T]: in which part of the episode each tick is."""
        return np.arange(len(self.actions)) * BINS // len(self.actions)


@dataclass(frozen=True)
class Dependence:
    """How much one arm depends on the others, by part of the episode.

    score: see above. low, high: where it lies with 95 % confidence (bootstrap of episodes).
    """

    score: Array
    low: Array
    high: Array
    overall: float


def dependence(
    episodes: Sequence[ObservedEpisode], own: NDArray[np.int64], arm: int, seed: int = 0
) -> Dependence:
    """Measure how much one arm depends on the others. own: the columns of the observations that its operator sees.

    Raises InvalidInput where there are fewer than MIN_EPISODES episodes.
    """
    if len(episodes) < MIN_EPISODES:
        raise InvalidInput(
            f"{len(episodes)} episodes were given; at least {MIN_EPISODES} tell something about dependence."
        )
    random = np.random.default_rng(seed)
    real, other = _stack(episodes, episodes, own), _stack(episodes, _partners(episodes, random), own)
    actions = np.concatenate([episode.actions[:, arm] for episode in episodes])
    actions = (actions - actions.mean(axis=0)) / np.maximum(actions.std(axis=0), _SMALLEST_SCALE)
    index = np.repeat(np.arange(len(episodes)), [len(episode.actions) for episode in episodes])
    features = _Features(real, random)
    errors = [_held_out(features(inputs), actions, index) for inputs in (real, other)]
    bins = np.concatenate([episode.bins for episode in episodes])
    sums = np.array([_sums(error, index, bins, len(episodes)) for error in errors])
    return _scores(sums, random)


def _partners(episodes: Sequence[ObservedEpisode], random: np.random.Generator) -> list[ObservedEpisode]:
    """Return for each episode another one of the same fold."""
    partner = np.arange(len(episodes))
    for fold in range(_FOLDS):
        members = partner[partner % _FOLDS == fold]
        shuffled = random.permutation(members)
        partner[shuffled] = np.roll(shuffled, 1)
    return [episodes[i] for i in partner.tolist()]


def _stack(
    episodes: Sequence[ObservedEpisode], partners: Sequence[ObservedEpisode], own: NDArray[np.int64]
) -> Array:
    """Return [ticks, width + 2]: own columns, the partner's at the same share of its length, and the time."""
    parts = []
    for episode, partner in zip(episodes, partners, strict=True):
        ticks = len(episode.actions)
        at = np.arange(ticks) * len(partner.actions) // ticks
        joined = partner.observations[at].copy()
        joined[:, own] = episode.observations[:ticks, own]
        time = np.stack([np.arange(ticks) / _CLOCK_TICKS, np.arange(ticks) / ticks], axis=1)
        parts.append(np.concatenate([joined, time], axis=1))
    return np.concatenate(parts)


class _Features:
    """Standardised observations, and random ReLU features of them; a constant."""

    def __init__(self, inputs: Array, random: np.random.Generator) -> None:
        self._mean, self._scale = inputs.mean(axis=0), np.maximum(inputs.std(axis=0), _SMALLEST_SCALE)
        width = inputs.shape[1]
        self._weights = random.normal(size=(width, _FEATURES)) / np.sqrt(width)
        self._offsets = random.uniform(-1.0, 1.0, _FEATURES)

    def __call__(self, inputs: Array) -> Array:
        x = np.clip((inputs - self._mean) / self._scale, -_LARGEST, _LARGEST)
        hidden = np.maximum(x @ self._weights + self._offsets, 0.0)
        return np.concatenate([x, hidden, np.ones((len(x), 1))], axis=1)


def _held_out(features: Array, actions: Array, index: NDArray[np.int64]) -> Array:
    """Return [ticks]: squared error of each tick, predicted without the episodes of its fold."""
    errors = np.empty(len(actions))
    for fold in range(_FOLDS):
        test = index % _FOLDS == fold
        x, y = features[~test], actions[~test]
        gram = x.T @ x + _RIDGE * len(x) * np.eye(x.shape[1])
        weights = np.linalg.solve(gram, x.T @ y)
        errors[test] = np.square(features[test] @ weights - actions[test]).sum(axis=1)
    return errors


def _sums(errors: Array, index: NDArray[np.int64], bins: NDArray[np.int64], episodes: int) -> Array:
    """Return errors summed by episode and part of it: [episodes, bins]."""
    sums = np.zeros((episodes, BINS))
    np.add.at(sums, (index, bins), errors)
    return sums


def _scores(sums: Array, random: np.random.Generator) -> Dependence:
    """Return the scores. sums: [2, episodes, bins], with and without the partners."""

    def score(chosen: NDArray[np.int64]) -> Array:
        known, unknown = sums[:, chosen].sum(axis=1)
        return 1.0 - known / np.maximum(unknown, 1e-12)

    episodes = int(sums.shape[1])
    resampled = [score(random.integers(episodes, size=episodes)) for _ in range(_RESAMPLES)]
    low, high = np.quantile(resampled, (0.025, 0.975), axis=0)
    known, unknown = sums.sum(axis=(1, 2))
    return Dependence(score(np.arange(episodes)), low, high, float(1.0 - known / unknown))
