"""Offer checkpoints of LeRobot to whatever loads policies: the entry point group `mart.policy_loaders`."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from mart.lerobot_policies.checkpoint import is_checkpoint, read_checkpoint
from mart.protocol.errors import Unavailable

if TYPE_CHECKING:
    from mart.lerobot_policies.policy import LeRobotPolicy


def load(folder: Path, device: str) -> LeRobotPolicy | None:
    """Return the policy in a folder, None where it is no checkpoint of LeRobot.

    Raises NotFound or Corrupt where it does not say what it takes or is damaged, Unavailable where LeRobot is not
    installed here.
    """
    if not is_checkpoint(folder):
        return None
    checkpoint = read_checkpoint(folder)
    if find_spec("lerobot") is None:
        raise Unavailable(
            f"{folder} is a checkpoint of LeRobot, which is not installed here; run this command in LeRobot's "
            "environment (docs/how-to-use-lerobot-policies.md)."
        )
    from mart.lerobot_policies.policy import LeRobotPolicy

    return LeRobotPolicy(checkpoint, device)
