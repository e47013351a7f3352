"""Numbers of episodes go on and never run out by one request."""

from __future__ import annotations

import pytest

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import OPERATOR_HUMAN, EpisodeRequest
from mart.protocol.received import MAX_NUMBER
from mart.sim.room.episode_state_machine import MAX_NUMBER_LEAP, EpisodeStateMachine
from mart.sim.room.seats import SeatTable


@pytest.mark.parametrize("number", [2**32 - 1, MAX_NUMBER, MAX_NUMBER_LEAP + 4])
def test_a_number_that_leaves_none_is_refused(number: int) -> None:
    seats = SeatTable(("arm0",))
    seats.claim("arm0", "ana", "Ana", OPERATOR_HUMAN)
    course = EpisodeStateMachine(room_seed=1, horizon_ticks=10, number=3)
    asked = EpisodeRequest(ready=EpisodeRequest.Ready(arm="arm0", holder_id="ana", ready=True, number=number))
    with pytest.raises(InvalidInput, match="open another room"):
        course.answer(asked, seats, 0.0)
    assert course.number == 3
