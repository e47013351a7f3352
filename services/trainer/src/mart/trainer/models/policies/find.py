"""Load whatever policy lies in a folder: one that was trained here, or one that another installed part knows.

A part offers a function under the entry point group `mart.policy_loaders`. It is given the folder and the device, and
returns a `Policy`, or None where the folder holds none of its kind.
"""

from __future__ import annotations

from importlib.metadata import entry_points
from pathlib import Path

from mart.trainer.models.checkpoint import RECORD
from mart.trainer.models.policies.policy import Policy

GROUP = "mart.policy_loaders"


def is_foreign(checkpoint: Path) -> bool:
    """Return whether a folder is there that holds no checkpoint of ours."""
    return checkpoint.is_dir() and not (checkpoint / RECORD).is_file()


def load_any_policy(checkpoint: Path, device: str = "cpu") -> Policy:
    """Load the policy in a folder.

    Raises NotFound where nobody here knows it, and what its loader raises: Corrupt where it is damaged, Unavailable
    where the device is not there.
    """
    if is_foreign(checkpoint):
        for offered in entry_points(group=GROUP):
            policy: Policy | None = offered.load()(checkpoint, device)
            if policy is not None:
                return policy
    from mart.trainer.models.policies.load import load_policy

    return load_policy(checkpoint, device)
