from __future__ import annotations

import numpy as np

from mart.sim.world.progress import first_reasons


def test_a_world_that_failed_for_several_reasons_tells_the_first() -> None:
    failed = {
        "the cube fell": np.array([True, False, False, True]),
        "time was wasted": np.array([True, True, False, False]),
    }
    assert first_reasons(failed, 4) == ["the cube fell", "time was wasted", "", "the cube fell"]


def test_where_nothing_can_fail_there_is_no_reason() -> None:
    assert first_reasons({}, 2) == ["", ""]
