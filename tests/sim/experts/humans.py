from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from mart.sim.experts import get_skill
from mart.sim.experts.human_error import HumanErrorModel


def human(skill: str = "expert", seed: int = 0, **changes: Any) -> HumanErrorModel:
    """Someone of a skill, some of whose numbers are others."""
    return HumanErrorModel(replace(get_skill(skill), **changes), np.random.default_rng(seed))
