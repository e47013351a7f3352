"""Drive arms by script: one operator per arm, which sees only what that arm's operator sees."""

from __future__ import annotations

from mart.sim.experts.expert import Expert
from mart.sim.experts.people import get_skill, skill_names
from mart.sim.experts.scripted_operator import ScriptedOperator
from mart.sim.experts.skill import Skill

__all__ = ["Expert", "ScriptedOperator", "Skill", "get_skill", "skill_names"]
