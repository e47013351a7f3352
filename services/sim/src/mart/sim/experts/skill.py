"""Say as data how well a scripted person drives.

The levels follow the paper's user groups. What separates them is what separates people: a novice is slower and shakier,
acts later on what is seen, overshoots, aims beside the thing, closes or lifts too early, lets things slip, rests more.
Nothing here decides an outcome: these are motions and timings, the physics and the clock say what comes of them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Skill:
    """Hold the numbers of a skill: times are means of what is drawn anew each time, noise is a standard deviation."""

    name: str
    reaction_s: float  # before the first movement
    notice_s: float  # until something seen (a partner ready, a thing lost, a goal missed) is acted upon
    settle_s: float  # at a place, before going on
    speed_m_per_s: float
    turn_rad_per_s: float
    tremor_m: float  # slow, so that it looks like a hand and not like noise
    tremor_rad: float
    overshoot: float  # of a movement's first part, over its length
    aim_m: float  # beside the thing to be gripped, anew at each attempt
    aim_rad: float
    haste: float  # probability of closing, and of moving on, before it is time
    slip_per_s: float  # how often a thing that is held is let go by mistake
    pause_probability: float  # of letting go of the clutch for a moment before the next movement
    pause_s: float


LEVELS = {
    skill.name: skill
    for skill in (
        Skill(
            name="expert",
            reaction_s=0.15,
            notice_s=0.15,
            settle_s=0.10,
            speed_m_per_s=0.30,
            turn_rad_per_s=1.8,
            tremor_m=0.0015,
            tremor_rad=0.010,
            overshoot=0.01,
            aim_m=0.002,
            aim_rad=0.02,
            haste=0.0,
            slip_per_s=0.0,
            pause_probability=0.0,
            pause_s=0.0,
        ),
        Skill(
            name="average",
            reaction_s=0.40,
            notice_s=0.35,
            settle_s=0.30,
            speed_m_per_s=0.17,
            turn_rad_per_s=1.2,
            tremor_m=0.0035,
            tremor_rad=0.025,
            overshoot=0.06,
            aim_m=0.008,
            aim_rad=0.10,
            haste=0.20,
            slip_per_s=0.05,
            pause_probability=0.25,
            pause_s=0.7,
        ),
        Skill(
            name="novice",
            reaction_s=0.80,
            notice_s=0.60,
            settle_s=0.45,
            speed_m_per_s=0.14,
            turn_rad_per_s=0.8,
            tremor_m=0.006,
            tremor_rad=0.045,
            overshoot=0.12,
            aim_m=0.010,
            aim_rad=0.20,
            haste=0.25,
            slip_per_s=0.06,
            pause_probability=0.35,
            pause_s=0.9,
        ),
    )
}
