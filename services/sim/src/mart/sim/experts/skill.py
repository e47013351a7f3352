"""How well a scripted person drives, as data.

The levels follow the paper's user groups; multi-cube lifting takes them about 3.5, 5 and 8 s.
"""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.errors import NotFound


@dataclass(frozen=True)
class Skill:
    """Times are means of what is drawn anew for each person; noise is the standard deviation of a slow tremor."""

    name: str
    reaction_s: float  # before the first movement
    speed_m_per_s: float
    turn_rad_per_s: float
    tremor_m: float
    tremor_rad: float
    settle_s: float  # at a place, before going on
    pause_probability: float  # of letting go of the clutch for a moment before the next movement
    pause_s: float


_SKILLS = {
    skill.name: skill
    for skill in (
        Skill("expert", 0.15, 0.30, 1.8, 0.0015, 0.010, 0.10, 0.00, 0.0),
        Skill("average", 0.40, 0.20, 1.2, 0.0040, 0.025, 0.25, 0.15, 0.5),
        Skill("novice", 0.80, 0.13, 0.8, 0.0070, 0.050, 0.50, 0.35, 0.9),
    )
}


def skill_names() -> tuple[str, ...]:
    return tuple(_SKILLS)


def get_skill(name: str) -> Skill:
    """Raises NotFound with the names that exist."""
    if name not in _SKILLS:
        raise NotFound.named("skill", name, _SKILLS)
    return _SKILLS[name]
