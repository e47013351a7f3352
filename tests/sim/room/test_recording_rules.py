"""Whatever people do one after another: nobody is recorded who may not be, and nothing in a practice room."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import MartError
from mart.protocol.messages import (
    EPISODE_PHASE_PRACTICE,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    EpisodeRequest,
    SeatRequest,
)
from mart.sim.room.episode_state_machine import COUNTDOWN_S, EpisodeStateMachine
from mart.sim.room.recording_rules import RecordingRules
from mart.sim.room.seats import SeatTable

ARMS = ("arm0", "arm1", "arm2")
PASSED = {"ana": True, "ben": False, "cem": True}

_SEAT_REQUESTS = st.one_of(
    st.builds(
        lambda arm, who: SeatRequest(
            claim=SeatRequest.Claim(
                arm=arm, holder_id=who, name=who, operator=OPERATOR_HUMAN, passed_course=PASSED[who]
            )
        ),
        st.sampled_from(ARMS),
        st.sampled_from(sorted(PASSED)),
    ),
    st.builds(
        lambda arm, who: SeatRequest(release=SeatRequest.Release(arm=arm, holder_id=who)),
        st.sampled_from(ARMS),
        st.sampled_from(sorted(PASSED)),
    ),
    st.builds(
        lambda arm: SeatRequest(assign=SeatRequest.Assign(arm=arm, operator=OPERATOR_SCRIPT)),
        st.sampled_from(ARMS),
    ),
)


def everybody_is_ready(
    rules: RecordingRules, seats: SeatTable, episode: EpisodeStateMachine, now_s: float
) -> None:
    """Whoever sits says so, one after another; where no human sits, anybody does. Raises where one is refused."""
    people = seats.of_operator(OPERATOR_HUMAN)
    for seat in people or tuple(seats)[:1]:
        ready = EpisodeRequest.Ready(arm=seat.arm, holder_id=seat.holder_id, ready=True)
        rules.require_may_begin(EpisodeRequest(ready=ready), seats)
        episode.answer(EpisodeRequest(ready=ready), seats, now_s)


@given(
    st.lists(st.one_of(_SEAT_REQUESTS, st.sampled_from(["ready", "time", "record"])), max_size=40),
    st.booleans(),
)
def test_whoever_is_recorded_has_passed_and_a_practice_room_records_nothing(
    words: list[SeatRequest | str], practice: bool
) -> None:
    rules = RecordingRules(practice=practice, course_required=not practice)
    seats, episode, now_s = SeatTable(ARMS), EpisodeStateMachine(1, 1000), 0.0
    for word in words:
        try:
            if isinstance(word, SeatRequest):
                rules.require_may_come(word, seats, practising=episode.phase == EPISODE_PHASE_PRACTICE)
                before = list(seats)
                if seats.answer(word) not in before:
                    episode.seats_changed(seats, now_s)
            if word in ("ready", "record"):
                everybody_is_ready(rules, seats, episode, now_s)
            if word in ("time", "record"):
                now_s += COUNTDOWN_S
                episode.advance(True, now_s)
        except MartError:
            continue
        if episode.recording:
            assert not practice
            assert all(seat.passed_course for seat in seats.of_operator(OPERATOR_HUMAN))
