"""The rights of the bus's parts: every key has somebody who may say it and somebody who may hear it."""

from __future__ import annotations

import itertools

import pytest

from mart.protocol import keys
from mart.protocol.rights import RIGHTS, BusPart, part_of
from mart.protocol.vocabulary import ServiceKind

_EVERY = sorted(
    key for name, key in vars(keys).items() if name.startswith("EVERY_") and name != "EVERY_ALIVE"
)


@pytest.mark.parametrize("key", _EVERY)
def test_every_key_has_both_ends(key: str) -> None:
    says, hears, serves, asks = (
        {part for part, rights in RIGHTS.items() if key in getattr(rights, word)}
        for word in ("says", "hears", "serves", "asks")
    )
    assert (says and hears) or (serves and asks), f"{key} has no right at one of its ends"


def test_rights_are_of_keys_alone() -> None:
    given = {
        key
        for rights in RIGHTS.values()
        for key in itertools.chain(rights.says, rights.hears, rights.serves, rights.asks)
    }
    assert given == set(_EVERY)


def test_every_part_has_rights_and_every_service_is_a_part() -> None:
    assert set(RIGHTS) == set(BusPart)
    assert {kind for kind in ServiceKind if part_of(kind) is None} == {ServiceKind.ROUTER, ServiceKind.TURN}
    for kind in ServiceKind:
        part = part_of(kind)
        assert part is None or kind in RIGHTS[part].announces


def test_nobody_but_rooms_says_what_the_world_is() -> None:
    assert [part for part, rights in RIGHTS.items() if keys.EVERY_STATE in rights.says] == [BusPart.SIM]


def test_the_pages_drive_nothing() -> None:
    assert RIGHTS[BusPart.WEB].says == ()
