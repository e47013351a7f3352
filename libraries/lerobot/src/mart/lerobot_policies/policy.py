"""Let a policy of LeRobot act as one of MART's: ACT, diffusion, and whatever else has LeRobot's own interface.

It is imported where LeRobot is installed. Several worlds are one batch: their chunks of actions begin together.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import torch
from lerobot.configs.policies import PreTrainedConfig
from lerobot.policies.factory import get_policy_class, make_pre_post_processors
from numpy.typing import NDArray

from mart.lerobot_policies import columns
from mart.lerobot_policies.checkpoint import PICTURE, LeRobotCheckpoint
from mart.protocol.errors import Corrupt, InvalidInput, NotFound, Unavailable
from mart.protocol.tasks import get_task
from mart.render import PictureSpec

if TYPE_CHECKING:
    from mart.lerobot_policies.columns import Array


class LeRobotPolicy:
    """Act with the policy of one checkpoint: a `mart.policies.SeeingPolicy`. It drives all arms together.

    What it samples is drawn from `begin`'s seed, for all worlds of a batch together.
    """

    def __init__(self, checkpoint: LeRobotCheckpoint, device: str = "cpu") -> None:
        """Load the weights. Raises Corrupt where they are damaged, Unavailable where the device is not there."""
        self._checkpoint = checkpoint
        facts = checkpoint.facts
        self.name = f"LeRobot's {checkpoint.kind}"
        self.task, self.control_hz = facts.task, facts.control_hz
        self.arms, self.arm_kinds = facts.arms, facts.arm_kinds
        named = [name for names in checkpoint.numbers.values() for name in names]
        self.needs = tuple(columns.observations_of(named))
        self.pictures = {
            feature: PictureSpec(feature.removeprefix(PICTURE), width_px, height_px)
            for feature, (height_px, width_px) in checkpoint.pictures.items()
        }
        self._instruction = get_task(facts.task, len(facts.arms), facts.arm_kinds).instruction
        self._device = _device(device)
        self._load()

    def _load(self) -> None:
        folder = str(self._checkpoint.folder)
        try:
            config = PreTrainedConfig.from_pretrained(folder)
            config.device = str(self._device)
            self._policy = get_policy_class(config.type).from_pretrained(folder, config=config)
            self._before, self._after = make_pre_post_processors(
                config,
                pretrained_path=folder,
                preprocessor_overrides={"device_processor": {"device": config.device}},
            )
        except Exception as error:  # anything that a damaged file or another version makes LeRobot raise
            raise Corrupt(
                f"{folder} cannot be loaded by LeRobot ({type(error).__name__}: {error})."
            ) from error

    def begin(self, worlds: int, seed: int) -> None:
        """Begin an episode: forget the last one's chunk of actions; see `Policy.begin`."""
        torch.manual_seed(seed)
        self._policy.reset()
        self._before.reset()
        self._after.reset()

    def act(self, observations: Mapping[str, NDArray[Any]]) -> Array:
        """Return what to do next, float64[worlds, arms, 7]; see `Policy.act`."""
        batch: dict[str, Any] = {
            feature: torch.from_numpy(columns.vector(names, observations))
            for feature, names in self._checkpoint.numbers.items()
        }
        for feature, size in self._checkpoint.pictures.items():
            batch[feature] = self._picture(feature, size, observations)
        worlds = len(next(iter(batch.values())))
        batch["task"] = [self._instruction] * worlds
        with torch.inference_mode():
            given = self._after(self._policy.select_action(self._before(batch)))
        return columns.actions(given.numpy(force=True), len(self.arms))

    def _picture(
        self, feature: str, size: tuple[int, int], observations: Mapping[str, NDArray[Any]]
    ) -> torch.Tensor:
        """Return float32[worlds, 3, height, width] in 0 … 1. LeRobot takes pictures of any size without a word."""
        picture = observations.get(feature)
        if picture is None or picture.shape[1:] != (*size, 3) or picture.dtype.name != "uint8":
            shown = "nothing" if picture is None else f"{picture.dtype} of shape {picture.shape}"
            raise InvalidInput(
                f"The policy was shown {shown} as {feature}; it takes pictures of {size[1]} x {size[0]} px."
            )
        return torch.from_numpy(picture).permute(0, 3, 1, 2).to(torch.float32) / 255.0

    def only(self, arm: str) -> LeRobotPolicy:
        """Raise NotFound for an unknown arm, and InvalidInput where there are others, too; see `Policy.only`."""
        if arm not in self.arms:
            raise NotFound.named("arm of this policy", arm, self.arms)
        if len(self.arms) > 1:
            raise InvalidInput(f"This policy drives {', '.join(self.arms)} together.")
        return self


def _device(name: str) -> torch.device:
    wanted = ("cuda" if torch.cuda.is_available() else "cpu") if name == "auto" else name
    try:
        torch.empty(1, device=wanted)
        return torch.device(wanted)
    except (RuntimeError, AssertionError) as error:
        raise Unavailable(f"The device {name!r} is not there; use cpu, or auto.") from error
