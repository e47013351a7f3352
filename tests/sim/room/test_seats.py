"""Who may drive which arm."""

from __future__ import annotations

import contextlib

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
from mart.sim.room.seats import SeatHolder, SeatTable, SeatTaken

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


@pytest.mark.parametrize("operator", [OPERATOR_HUMAN, OPERATOR_UNSPECIFIED])
def test_people_are_not_assigned(seats: SeatTable, operator: Operator) -> None:
    with pytest.raises(InvalidInput):
        seats.assign("arm0", operator)


def test_a_promoted_policy_is_assigned_by_name(seats: SeatTable) -> None:
    seat = seats.assign("arm0", OPERATOR_POLICY, "lifter")
    assert (seat.operator, seat.holder_id, seat.name, seat.driver.policy) == (
        OPERATOR_POLICY,
        "",
        "lifter",
        "lifter",
    )
    assert seats.assign("arm0", OPERATOR_POLICY, "lifter") == seat
    assert seats.assign("arm0", OPERATOR_POLICY, "other").epoch == seat.epoch + 1
    assert seats.assign("arm0", OPERATOR_HOLD).operator == OPERATOR_HOLD


@pytest.mark.parametrize(
    ("operator", "policy"),
    [
        (OPERATOR_POLICY, ""),
        (OPERATOR_SCRIPT, "x"),
        (OPERATOR_HOLD, "x"),
        (OPERATOR_POLICY, "x" * 65),
        (OPERATOR_POLICY, "../x"),
    ],
)
def test_only_a_policy_seat_names_a_policy(seats: SeatTable, operator: Operator, policy: str) -> None:
    with pytest.raises(InvalidInput):
        seats.assign("arm0", operator, policy)


def seat_a_machine(seats: SeatTable, kind: str) -> SeatHolder:
    match kind:
        case "script":
            return seats.assign("arm0", OPERATOR_SCRIPT)
        case "promoted policy":
            return seats.assign("arm0", OPERATOR_POLICY, "lifter")
        case _:
            return seats.claim("arm0", "operate-1", "d-HBC", OPERATOR_POLICY)


machines = pytest.mark.parametrize("kind", ["script", "promoted policy", "policy of one's own"])


@machines
def test_a_person_takes_over_from_a_machine_and_hands_back(seats: SeatTable, kind: str) -> None:
    machine = seat_a_machine(seats, kind)
    taken = seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    assert (taken.operator, taken.epoch, taken.relieved) == (
        OPERATOR_HUMAN,
        machine.epoch + 1,
        machine.driver,
    )
    assert seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN) == taken
    back = seats.hand_back("arm0", "h1")
    assert (back.driver, back.epoch, back.relieved) == (machine.driver, machine.epoch + 2, None)


@machines
def test_whoever_took_over_may_also_leave(seats: SeatTable, kind: str) -> None:
    seat_a_machine(seats, kind)
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    left = seats.release("arm0", "h1")
    assert (left.operator, left.relieved) == (OPERATOR_HOLD, None)


@machines
def test_only_who_took_over_hands_back(seats: SeatTable, kind: str) -> None:
    seat_a_machine(seats, kind)
    taken = seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    for other in ("h2", "operate-1", ""):
        with pytest.raises(Forbidden):
            seats.hand_back("arm0", other)
    assert seats["arm0"] == taken


def test_a_seat_that_was_free_is_not_handed_back(seats: SeatTable) -> None:
    seats.claim("arm0", "h1", "Ana", OPERATOR_HUMAN)
    with pytest.raises(Conflict):
        seats.hand_back("arm0", "h1")


def test_two_policies_of_ones_own_do_not_push_each_other_out(seats: SeatTable) -> None:
    seats.claim("arm0", "operate-1", "d-HBC", OPERATOR_POLICY)
    with pytest.raises(SeatTaken):
        seats.claim("arm0", "operate-2", "HBC", OPERATOR_POLICY)


@pytest.mark.parametrize("operator", [OPERATOR_HOLD, OPERATOR_SCRIPT, OPERATOR_UNSPECIFIED])
def test_only_people_and_policies_claim(seats: SeatTable, operator: Operator) -> None:
    with pytest.raises(InvalidInput):
        seats.claim("arm0", "h1", "Ana", operator)


@pytest.mark.parametrize(
    ("holder_id", "name"), [("", "Ana"), ("h1", ""), ("h" * 129, "Ana"), ("h1", "A" * 65), ("h1", "A\nB")]
)
def test_holders_and_names_are_bounded(seats: SeatTable, holder_id: str, name: str) -> None:
    with pytest.raises(InvalidInput):
        seats.claim("arm0", holder_id, name, OPERATOR_HUMAN)


def test_an_unknown_arm_is_named_with_those_that_exist(seats: SeatTable) -> None:
    with pytest.raises(NotFound):
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
policies = st.sampled_from(["", "lifter"])
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
        lambda arm, operator, policy: SeatRequest(
            assign=SeatRequest.Assign(arm=arm, operator=operator, policy=policy)
        ),
        arms,
        operators,
        policies,
    ),
    st.builds(
        lambda arm, holder: SeatRequest(hand_back=SeatRequest.HandBack(arm=arm, holder_id=holder)),
        arms,
        holders,
    ),
)


@given(st.lists(requests, max_size=30))
def test_the_epoch_grows_with_every_change_and_with_nothing_else(episode: list[SeatRequest]) -> None:
    seats = SeatTable(ARMS)
    for request in episode:
        before = {seat.arm: seat for seat in seats}
        try:
            seats.answer(request)
        except MartError:
            assert {seat.arm: seat for seat in seats} == before
        for seat in seats:
            changed = seat != before[seat.arm]
            assert seat.epoch == before[seat.arm].epoch + changed
            assert is_whole(seat)


def is_whole(seat: SeatHolder) -> bool:
    """Somebody in particular holds it, or a promoted policy has its name, or neither."""
    held = {OPERATOR_HUMAN: True, OPERATOR_POLICY: not seat.driver.policy}.get(seat.operator, False)
    relieves = seat.relieved is not None and seat.relieved.is_machine and seat.operator == OPERATOR_HUMAN
    return bool(seat.holder_id) == held and (relieves or seat.relieved is None)


@given(st.lists(requests, max_size=30))
def test_nobody_is_driven_out_by_another_than_a_person(episode: list[SeatRequest]) -> None:
    seats = SeatTable(ARMS)
    for request in episode:
        before = {seat.arm: seat for seat in seats}
        with contextlib.suppress(MartError):
            seats.answer(request)
        for seat in seats:
            was = before[seat.arm]
            if seat != was and was.operator == OPERATOR_HUMAN:
                asked = getattr(request, request.WhichOneof("what") or "")
                assert asked.holder_id == was.holder_id
