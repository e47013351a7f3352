"""Say what a step was run with."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version

_PARTS = ("mart-platform", "mart-sim", "mart-recorder", "mart-trainer", "mujoco", "numpy", "torch")


@cache
def versions() -> Mapping[str, str]:
    """Return the versions of Python, of the parts that make results, and of what these compute with."""
    found = {"python": platform.python_version(), "machine": platform.machine()}
    for part in _PARTS:
        try:
            found[part] = version(part)
        except PackageNotFoundError:
            continue
    return found
