"""Learning one arm alone in some windows, whatever the other arms are seen to do.

A joint network is shown all arms and learns from few episodes how they happen to go together. In a share of the windows
one arm, drawn, counts alone: its action, and what of the subgoal it sees. Everything that its operator does not see is
hidden: taken from another window of the batch (`swap`), told as the mean (`drop`), or blurred by noise of one
deviation of the data (`blur`). In the other windows all arms count, as seen. Swapping is what Pitis et al.,
"Counterfactual Data Augmentation using Locally Factored Dynamics" (2020) do with parts that do not touch.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.hyperparameters import Hiding
from mart.trainer.models.rng import Rng


@dataclass(frozen=True)
class OneArmWindows:
    """Windows of which some are for one arm alone.

    obs: float32[S, T, B, D]. goal: float32[S, B, D].
    counted: float32[S, B, arms], how much each arm's part counts: 1 each, or all of it for one arm.
    told: bool[S, B, D], which columns are as recorded.
    """

    obs: Tensor
    goal: Tensor
    counted: Tensor
    told: Tensor


def seen_by_arm(layout: ObservationLayout) -> Tensor:
    """Return bool[arms, D]: which columns each arm's operator sees."""
    seen = torch.zeros(len(layout.arms), layout.width, dtype=torch.bool)
    for own, arm in zip(seen, layout.arms, strict=True):
        own[torch.from_numpy(layout.columns_of(arm))] = True
    return seen


def for_one_arm(
    obs: Tensor, goal: Tensor, seen: Tensor, rng: Rng, *, share: float, hiding: Hiding
) -> OneArmWindows:
    """Let one arm count alone in `share` of the windows, and hide from it what it does not see.

    obs: normalised, float32[S, T, B, D]. goal: float32[S, B, D]. seen: bool[arms, D]. share: above 0, up to 1.
    """
    windows, arms = obs.shape[2], len(seen)
    drawn = rng.uniform(1, windows) / share
    alone = drawn < 1
    arm = (drawn * arms).long().clamp(max=arms - 1)
    told = seen[arm] | ~alone[..., None]
    one = torch.nn.functional.one_hot(arm, arms) * float(arms)
    counted = torch.where(alone[..., None], one, 1.0)
    hide = {"swap": _swapped, "drop": _dropped, "blur": _blurred}[hiding]
    hidden_obs, hidden_goal = hide(obs, goal, rng)
    return OneArmWindows(
        torch.where(told[:, None], obs, hidden_obs), torch.where(told, goal, hidden_goal), counted, told
    )


def _swapped(obs: Tensor, goal: Tensor, rng: Rng) -> tuple[Tensor, Tensor]:
    """Return another window for each, the same for all its ticks and its goal."""
    windows = obs.shape[2]
    steps = (rng.uniform(1, windows) * (windows - 1)).long() + 1
    other = ((torch.arange(windows, device=obs.device) + steps) % windows)[..., None].expand_as(goal)
    return torch.gather(obs, 2, other[:, None].expand_as(obs)), torch.gather(goal, 1, other)


def _dropped(obs: Tensor, goal: Tensor, rng: Rng) -> tuple[Tensor, Tensor]:
    del rng
    return torch.zeros_like(obs), torch.zeros_like(goal)


def _blurred(obs: Tensor, goal: Tensor, rng: Rng) -> tuple[Tensor, Tensor]:
    """Return what is seen beside itself by the same amount in all ticks: what moves still moves as it did."""
    noise = rng.normal(1, *goal.shape[1:])
    return obs + noise[:, None], goal + noise
