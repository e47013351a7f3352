"""Find skills and tempers by their names."""

from __future__ import annotations

from mart.protocol.errors import NotFound
from mart.sim.experts.skill import LEVELS, Skill
from mart.sim.experts.tempers import TEMPERS

_SKILLS = {**LEVELS, **TEMPERS}


def skill_names() -> tuple[str, ...]:
    """Return the names of all skills: the levels, the best first, then the tempers."""
    return tuple(_SKILLS)


def get_skill(name: str) -> Skill:
    """Return the skill of this name; raises NotFound with the names that exist."""
    if name not in _SKILLS:
        raise NotFound.named("skill", name, _SKILLS)
    return _SKILLS[name]
