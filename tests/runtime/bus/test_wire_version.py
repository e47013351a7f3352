"""A router that speaks another version of the wire is named at once."""

from __future__ import annotations

import pytest

from mart.protocol import keys
from mart.protocol.errors import Conflict, Forbidden
from mart.protocol.wire_version import BUS_WIRE_VERSION
from mart.runtime.bus.admission import confirm_rights, require_rights
from mart.runtime.bus.memory import MemoryNetwork

_ENDPOINT = "tls/127.0.0.1:7447"


def test_another_version_is_named() -> None:
    bus = MemoryNetwork().connect()
    bus.serve(keys.admission(), lambda request: request.reply(b"7"))
    with pytest.raises(
        Conflict, match=f"speaks version 7 of the wire, and this program version {BUS_WIRE_VERSION}"
    ):
        require_rights(_ENDPOINT, bus)


def test_our_own_version_is_good() -> None:
    bus = MemoryNetwork().connect()
    bus.serve(keys.admission(), confirm_rights)
    require_rights(_ENDPOINT, bus)


def test_no_answer_is_no_rights() -> None:
    with pytest.raises(Forbidden, match="no rights"):
        require_rights(_ENDPOINT, MemoryNetwork().connect())


def test_a_router_with_a_secret_is_not_asked() -> None:
    require_rights("tcp/127.0.0.1:7447", MemoryNetwork().connect())
