"""Who drives, as one option says it."""

from __future__ import annotations

import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.runtime.skill_option import SKILLS, ScriptedPerson, parse_people


def test_one_skill_is_everybodys() -> None:
    assert parse_people("average", 2) == (ScriptedPerson("", "average"),) * 2


def test_each_arm_may_have_somebody_with_a_name() -> None:
    assert parse_people("ada=hasty,ben=careful,expert", 3) == (
        ScriptedPerson("ada", "hasty"),
        ScriptedPerson("ben", "careful"),
        ScriptedPerson("", "expert"),
    )


def test_what_cannot_drive_is_said_with_what_can() -> None:
    with pytest.raises(NotFound, match="learning"):
        parse_people("master", 2)
    with pytest.raises(InvalidInput, match="2 skills were given for 3 arms"):
        parse_people("hasty,careful", 3)
    with pytest.raises(InvalidInput, match="cannot name"):
        parse_people("=hasty,careful", 2)


def test_every_skill_has_another_name() -> None:
    assert len(set(SKILLS)) == len(SKILLS)
