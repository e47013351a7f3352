from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.web.lobby.live_services import LiveServices

GATEWAY = keys.alive(ServiceKind.GATEWAY, "gateway-1")
SIM = keys.alive(ServiceKind.SIM, "room-1")
TOKENS = st.sets(st.sampled_from([GATEWAY, SIM, keys.alive(ServiceKind.SIM, "room-2")]))


def services(*alive: str) -> LiveServices:
    told = LiveServices()
    for key in alive:
        told.tell(key, True)
    return told


def test_who_is_alive_is_told_by_kind() -> None:
    told = services(SIM, keys.alive(ServiceKind.SIM, "room-0"), GATEWAY)
    assert told.by_kind() == {"gateway": ["gateway-1"], "sim": ["room-0", "room-1"]}
    told.tell(GATEWAY, False)
    assert told.ids(ServiceKind.GATEWAY) == []


@given(told=TOKENS, listed=TOKENS)
def test_two_lists_in_a_row_show_every_word_that_was_lost_and_nothing_else(
    told: set[str], listed: set[str]
) -> None:
    known = services(*told)
    assert known.compare(listed) == {}
    assert known.compare(listed) == {key: key in listed for key in told ^ listed}


def test_a_list_that_is_older_than_the_newest_word_changes_nothing() -> None:
    known = services(SIM)
    known.compare([SIM, GATEWAY])
    known.tell(GATEWAY, True)
    known.tell(GATEWAY, False)
    assert known.compare([SIM, GATEWAY]) == {}
    assert known.compare([SIM]) == {}
