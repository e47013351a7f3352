"""Who may drive which arm."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, MartError, NotFound
from mart.protocol.messages import (
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    OPERATOR_UNSPECIFIED,
    Operator,
    SeatRequest,
)
from mart.sim.seats import SeatTable, SeatTaken

ARMS = ("arm0", "arm1")


@pytest.fixture
def seats() -> SeatTable:
    return SeatTable(ARMS)


def test_a_room_begins_on_hold(seats: SeatTable) -> None:
    assert [(seat.arm, seat.operator, seat.epoch) for seat in seats] == [
        ("arm0", OPERATOR_HOLD, 1),
        ("arm1", OPERATOR_HOLD, 1),
    ]


def test_a_free_seat_is_claimed_under_a_new_epoch(seats: SeatTable) -> None:
    seat = seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    assert (seat.operator, seat.epoch, seat.holder_id, seat.name) == (OPERATOR_HUMAN, 2, "h1", "Ana")
    assert seats["arm0"] == seat


def test_a_script_makes_room_for_a_person(seats: SeatTable) -> None:
    seats.assign("arm0", OPERATOR_SCRIPT)
    assert seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN).epoch == 3


def test_its_holder_gets_a_seat_back_unchanged(seats: SeatTable) -> None:
    seat = seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    assert seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN) == seat


def test_a_second_claim_is_a_conflict_that_names_the_holder(seats: SeatTable) -> None:
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    with pytest.raises(SeatTaken, match="Ana"):
        seats.claim("arm0", "h2", "Ben", OPERATOR_HUMAN)
    with pytest.raises(Conflict):
        seats.assign("arm0", OPERATOR_SCRIPT)
    assert seats["arm0"].holder_id == "h1"


def test_a_holder_may_hand_the_seat_to_the_own_policy(seats: SeatTable) -> None:
    human = seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    assert seats.claim("arm0", "h1", "Ana", OPERATOR_POLICY).epoch == human.epoch + 1


def test_a_seat_that_is_left_goes_on_hold(seats: SeatTable) -> None:
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    seat = seats.release("arm0", "h1")
    assert (seat.operator, seat.epoch, seat.holder_id, seat.name) == (OPERATOR_HOLD, 3, "", "")
    assert seats.release("arm0", "h1") == seat  # leaving twice is no fault


@pytest.mark.parametrize("holder_id", ["h2", ""])
def test_only_its_holder_leaves_a_seat(seats: SeatTable, holder_id: str) -> None:
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    with pytest.raises(Forbidden):
        seats.release("arm0", holder_id)


def test_a_script_is_not_left_but_replaced(seats: SeatTable) -> None:
    seats.assign("arm0", OPERATOR_SCRIPT)
    with pytest.raises(Forbidden):
        seats.release("arm0", "")


def test_setting_the_same_operator_again_changes_nothing(seats: SeatTable) -> None:
    seat = seats.assign("arm0", OPERATOR_SCRIPT)
    assert seats.assign("arm0", OPERATOR_SCRIPT) == seat


@pytest.mark.parametrize("operator", [OPERATOR_HUMAN, OPERATOR_POLICY, OPERATOR_UNSPECIFIED])
def test_people_and_policies_are_not_assigned(seats: SeatTable, operator: Operator) -> None:
    with pytest.raises(InvalidInput):
        seats.assign("arm0", operator)


@pytest.mark.parametrize("operator", [OPERATOR_HOLD, OPERATOR_SCRIPT, OPERATOR_UNSPECIFIED])
def test_only_people_and_policies_claim(seats: SeatTable, operator: Operator) -> None:
    with pytest.raises(InvalidInput):
        seats.claim("arm0", "h1", "Ana", operator)


@pytest.mark.parametrize(
    ("holder_id", "name"), [("", "Ana"), ("h1", ""), ("h" * 129, "Ana"), ("h1", "A" * 41), ("h1", "A\nB")]
)
def test_holders_and_names_are_bounded(seats: SeatTable, holder_id: str, name: str) -> None:
    with pytest.raises(InvalidInput):
        seats.claim("arm0", holder_id, name, OPERATOR_HUMAN)


def test_an_unknown_arm_is_named_with_those_that_exist(seats: SeatTable) -> None:
    with pytest.raises(NotFound, match=r"arm9.*arm0, arm1"):
        seats.claim("arm9", "h1", "Ana", OPERATOR_HUMAN)


def test_an_empty_request_is_invalid(seats: SeatTable) -> None:
    with pytest.raises(InvalidInput):
        seats.answer(SeatRequest())


def test_seats_are_restored_where_their_arm_still_exists(seats: SeatTable) -> None:
    seats.claim("arm1", "h1", "Ana", OPERATOR_HUMAN)
    later = SeatTable(["arm1", "arm2"])
    later.restore(seats)
    assert [(seat.arm, seat.epoch, seat.name) for seat in later] == [("arm1", 2, "Ana"), ("arm2", 1, "")]


arms = st.sampled_from([*ARMS, "arm9"])
holders = st.sampled_from(["", "h1", "h2"])
operators = st.sampled_from(range(6))
requests = st.one_of(
    st.builds(
        lambda arm, holder, operator: SeatRequest(
            claim=SeatRequest.Claim(arm=arm, holder_id=holder, name="someone", operator=operator)
        ),
        arms,
        holders,
        operators,
    ),
    st.builds(
        lambda arm, holder: SeatRequest(release=SeatRequest.Release(arm=arm, holder_id=holder)), arms, holders
    ),
    st.builds(
        lambda arm, operator: SeatRequest(assign=SeatRequest.Assign(arm=arm, operator=operator)),
        arms,
        operators,
    ),
)


@given(st.lists(requests, max_size=30))
def test_the_epoch_grows_with_every_change_and_with_nothing_else(course: list[SeatRequest]) -> None:
    seats = SeatTable(ARMS)
    for request in course:
        before = {seat.arm: seat for seat in seats}
        try:
            seats.answer(request)
        except MartError:
            assert {seat.arm: seat for seat in seats} == before
        for seat in seats:
            changed = seat != before[seat.arm]
            assert seat.epoch == before[seat.arm].epoch + changed
            assert bool(seat.holder_id) == (seat.operator in (OPERATOR_HUMAN, OPERATOR_POLICY))
