"""A holder recognises the seat; nobody else learns who holds it."""

from __future__ import annotations

from hypothesis import given

from mart.protocol.holders import holder_tag, is_held_by
from mart.protocol.messages import Seat
from tests.protocol.message_examples import printable_text

_IDS = printable_text(min_size=1, max_size=128)


def seat(holder_id: str, epoch: int = 2, salt: str = "17c0", arm: str = "arm0") -> Seat:
    return Seat(arm=arm, epoch=epoch, holder_tag=holder_tag(salt, arm, epoch, holder_id))


@given(holder=_IDS, other=_IDS)
def test_a_seat_is_its_holders_and_no_others(holder: str, other: str) -> None:
    assert is_held_by(seat(holder), holder)
    assert is_held_by(seat(holder), other) == (holder == other)
    assert not is_held_by(seat(holder), "")


def test_a_seat_that_nobody_holds_is_nobodys() -> None:
    assert seat("").holder_tag == ""
    for claimed in ("", "ana", "17c0-"):
        assert not is_held_by(seat(""), claimed)
        assert not is_held_by(Seat(arm="arm0", epoch=2, holder_tag="-"), claimed)


def test_a_tag_links_neither_seats_nor_epochs_nor_rooms() -> None:
    one_persons = [seat("ana"), seat("ana", epoch=3), seat("ana", salt="17c1"), seat("ana", arm="arm1")]
    assert len({one.holder_tag for one in one_persons}) == len(one_persons)
    assert not any("ana" in one.holder_tag for one in one_persons)
