from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.web.access.connection_table import KEPT_S, SILENT_S, ConnectionTable, Peer

STRANGER, ANA = "10.0.0.66", "10.0.0.1"


def test_who_asks_nothing_gives_way_to_whoever_comes_the_oldest_first() -> None:
    table = ConnectionTable(per_address=2, in_all=100)
    assert table.open((STRANGER, 1), 0.0) is None
    assert table.open((STRANGER, 2), 1.0) is None
    assert table.open((STRANGER, 3), 2.0) == (STRANGER, 1)


def test_one_that_never_asked_goes_before_one_that_rests() -> None:
    table = ConnectionTable(per_address=2, in_all=100)
    table.open((ANA, 1), 0.0)
    with table.asking((ANA, 1), lambda: 0.5):
        pass
    table.open((ANA, 2), 1.0)
    assert table.open((ANA, 3), 2.0) == (ANA, 2)


def test_nothing_that_is_being_answered_is_ended_for_another() -> None:
    table = ConnectionTable(per_address=2, in_all=100)
    for port in (1, 2):
        table.open((ANA, port), 0.0)
    with table.asking((ANA, 1), lambda: 1.0), table.asking((ANA, 2), lambda: 1.0):
        assert table.open((ANA, 3), 1.0) == (ANA, 3)
        table.close((ANA, 3))
        assert table.overdue(1e9) == []


def test_other_addresses_are_not_touched_by_ones_limit() -> None:
    table = ConnectionTable(per_address=3, in_all=100)
    table.open((ANA, 1), 0.0)
    for port in range(50):
        ended = table.open((STRANGER, port), 1.0)
        assert ended is None or ended[0] == STRANGER
        if ended:
            table.close(ended)
    assert len(table) == 4


def test_a_network_of_ipv6_is_one_address_and_a_proxy_none() -> None:
    table = ConnectionTable(per_address=2, in_all=100, shared=["127.0.0.1"])
    table.open(("2001:db8::1", 1), 0.0)
    table.open(("2001:db8::2", 1), 0.0)
    assert table.open(("2001:db8::3", 1), 0.0) == ("2001:db8::1", 1)
    assert [table.open(("127.0.0.1", port), 0.0) for port in range(9)] == [None] * 9


def test_a_connection_that_asks_nothing_for_too_long_is_overdue() -> None:
    table = ConnectionTable(per_address=9, in_all=9)
    table.open((ANA, 1), 0.0)
    table.open((ANA, 2), 0.0)
    with table.asking((ANA, 2), lambda: 1000.0):
        assert table.overdue(SILENT_S + 1.0) == [(ANA, 1)]
    assert table.overdue(1001.0 + SILENT_S) == table.overdue(1000.0 + KEPT_S) == [(ANA, 1)]
    assert len(table.overdue(1001.0 + KEPT_S)) == 2


def test_a_request_that_fails_earns_no_patience() -> None:
    table = ConnectionTable(per_address=4, in_all=7)
    table.open((ANA, 1), 0.0)
    with pytest.raises(TimeoutError), table.asking((ANA, 1), lambda: 10.0):
        raise TimeoutError
    assert table.overdue(11.0 + SILENT_S) == [(ANA, 1)]


@given(
    st.lists(
        st.tuples(st.sampled_from("abc"), st.integers(1, 12), st.sampled_from(["open", "close", "ask"])),
        max_size=80,
    )
)
def test_no_limit_is_ever_passed(acts: list[tuple[str, int, str]]) -> None:
    table = ConnectionTable(per_address=4, in_all=7)
    is_open: set[Peer] = set()
    for now_s, (address, port, act) in enumerate(acts):
        peer = (address, port)
        match act:
            case "open":
                is_open.add(peer)
                ended = table.open(peer, float(now_s))
                if ended is not None:
                    table.close(ended)
                    is_open.discard(ended)
            case "close":
                table.close(peer)
                is_open.discard(peer)
            case _:
                with table.asking(peer, lambda: float(now_s)):  # noqa: B023 - called within the block
                    pass
        assert len(table) == len(is_open) <= 7
        assert all(sum(one[0] == name for one in is_open) <= 4 for name in "abc")
