"""Who held the seats, tick by tick: as the record of operators says it, through edits and other rates."""

from __future__ import annotations

import numpy as np

from mart.episodes import arrays_from_states
from mart.episodes.holders import UNKNOWN, holders_of
from mart.protocol.recording import OperatorsRecord
from tests.episodes.test_arrays import observed_states

RECORD = OperatorsRecord.from_strings(
    {"arm0": "human Ana | tick 3: hold | tick 5: human Ben | tick 8: human Ana", "arm1": "script"}
)


def test_a_shift_counts_from_its_state_on_and_who_comes_back_is_the_same() -> None:
    found, names = holders_of(RECORD, ("arm0", "arm1", "arm2"), np.arange(1, 11))
    assert names == ("human Ana", "hold", "human Ben", "script")
    assert found[:, 0].tolist() == [0, 0, 1, 1, 2, 2, 2, 0, 0, 0]
    assert set(found[:, 1]) == {3}
    assert set(found[:, 2]) == {UNKNOWN}


def test_states_alone_do_not_say_who_it_was_and_the_record_does() -> None:
    states = observed_states()
    assert (arrays_from_states(states).holders == UNKNOWN).all()
    data = arrays_from_states(states, operators=RECORD)
    assert data.holders[:, 0].tolist() == [0, 0, 1, 1, 2, 2]
    assert {data.holder_names[number] for number in data.holders[:, 1]} == {"script"}
