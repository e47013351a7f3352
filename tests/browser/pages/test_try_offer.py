"""The lobby's first button gives the seat that it names, or says why it does not."""

from __future__ import annotations

from typing import Any

from tests.browser.pages.conftest import Run

OFFER = """({ TryOffer }, steps) => {
  const offer = new TryOffer();
  return steps.map(([nowMs, rooms]) => {
    if (rooms) offer.update(rooms, nowMs);
    return rooms ? offer.place && `${offer.place.room.room} ${offer.place.seat.arm}` : offer.news(nowMs);
  });
}"""


def room(name: str, *operators: str, stale: bool = False, mine: str = "") -> dict[str, Any]:
    seats = [
        {
            "arm": f"arm{index}",
            "operator": operator,
            "name": "Ben" * (operator == "human"),
            "mine": mine == f"arm{index}",
        }
        for index, operator in enumerate(operators)
    ]
    return {"room": name, "stale": stale, "seats": seats}


def offered(run: Run, *steps: tuple[int, Any]) -> list[str | None]:
    told: list[str | None] = run("try-offer.js", OFFER, [list(step) for step in steps])
    return told


def test_a_seat_that_was_named_stays_named_while_it_is_free(run: Run) -> None:
    first, second = room("room-1", "hold", "hold"), room("room-2", "hold", "hold")
    late = room("room-1", "script", "hold", stale=True)
    assert offered(
        run, (0, [second]), (500, [first, second]), (600, [first]), (5000, [late]), (5100, [first])
    ) == ["room-2 arm0", "room-2 arm0", "room-1 arm0", "room-1 arm0", "room-1 arm0"]
    assert offered(run, (0, [late]), (100, [late, second])) == [None, "room-2 arm0"]


def test_whoever_presses_just_after_another_seat_is_named_is_told_first(run: Run) -> None:
    free, taken = [room("room-1", "hold", "hold")], [room("room-1", "human", "hold")]
    assert offered(run, (0, free), (5000, taken), (5300, None), (5600, None)) == [
        "room-1 arm0",
        "room-1 arm1",
        "Ben has just taken the blue arm. Press again for the orange arm.",
        "",
    ]
    assert offered(run, (0, free), (5000, taken), (8000, None))[2] == ""
    closed = offered(run, (0, free), (5000, [room("room-2", "hold")]), (5300, None))
    assert closed[2] == "room-1 was closed. Press again for the blue arm."


def test_ones_own_seat_comes_before_all(run: Run) -> None:
    own = [room("room-1", "hold", "human", mine="arm1")]
    assert offered(run, (0, [room("room-1", "hold", "hold")]), (10, own), (20, None)) == [
        "room-1 arm0",
        "room-1 arm1",
        "",
    ]
