"""Say as data how people of different tempers drive, and how one who is new to it gets better.

Each temper starts from the average person's numbers (`skill.LEVELS`) and moves those that its name is about. What a
temper trades is not ours to choose freely:

- Speed against accuracy. The error with which a quick movement ends grows in proportion to its speed (Schmidt and
  others, Psychological Review 86, 1979; Meyer and others, Psychological Review 95, 1988). `hasty` is 1.6 times as fast
  as average, has 1.6 times its overshoot and aims 1.3 times as wide; `careful` moves at 0.65 of the speed with 0.65 of
  the overshoot and half the miss, for it also looks twice as long before it closes.
- Waiting against acting. `impatient` moves like an average person and acts early: a third of the time to look, twice
  the haste, half the rests. What is held slips from it no more often than from others.
- Practice. Time and errors fall with a power of the number of trials (Newell and Rosenbloom, "Mechanisms of skill
  acquisition and the law of practice", 1981). `learning` begins as a novice; what it lacks to an average person falls
  as episode^-0.4, which leaves half of it after 6 episodes and a quarter after 32: exponents from 0.2 to 0.6 are usual.
"""

from __future__ import annotations

from dataclasses import fields, replace

from mart.sim.experts.skill import LEVELS, Skill

LEARNING = "learning"
_PRACTICE_EXPONENT = 0.4

_AVERAGE = LEVELS["average"]

TEMPERS = {
    skill.name: skill
    for skill in (
        replace(
            _AVERAGE,
            name="hasty",
            reaction_s=0.25,
            settle_s=0.15,
            speed_m_per_s=1.6 * _AVERAGE.speed_m_per_s,
            turn_rad_per_s=1.4 * _AVERAGE.turn_rad_per_s,
            overshoot=1.6 * _AVERAGE.overshoot,
            aim_m=1.3 * _AVERAGE.aim_m,
            aim_rad=1.3 * _AVERAGE.aim_rad,
            haste=0.30,
            pause_probability=0.10,
            pause_s=0.4,
        ),
        replace(
            _AVERAGE,
            name="careful",
            reaction_s=0.50,
            settle_s=2.0 * _AVERAGE.settle_s,
            speed_m_per_s=0.65 * _AVERAGE.speed_m_per_s,
            turn_rad_per_s=0.65 * _AVERAGE.turn_rad_per_s,
            overshoot=0.65 * _AVERAGE.overshoot,
            aim_m=0.5 * _AVERAGE.aim_m,
            aim_rad=0.5 * _AVERAGE.aim_rad,
            haste=0.02,
            slip_per_s=0.01,
        ),
        replace(
            _AVERAGE,
            name="impatient",
            reaction_s=0.20,
            notice_s=0.25,
            settle_s=_AVERAGE.settle_s / 3.0,
            haste=2.0 * _AVERAGE.haste,
            pause_probability=_AVERAGE.pause_probability / 2.0,
        ),
        replace(LEVELS["novice"], name=LEARNING),
    )
}


def practised(skill: Skill, episode: int) -> Skill:
    """Return a skill as it is in an episode, counted from 1: only `learning` changes, from novice towards average."""
    if skill.name != LEARNING:
        return skill
    left = max(episode, 1) ** -_PRACTICE_EXPONENT
    numbers = {
        field.name: getattr(_AVERAGE, field.name)
        + left * (getattr(skill, field.name) - getattr(_AVERAGE, field.name))
        for field in fields(skill)
        if field.name != "name"
    }
    return replace(skill, **numbers)
