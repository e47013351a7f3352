"""Who is alive: a word may be lost, and a router that is started anew forgets all for a moment."""

from __future__ import annotations

import contextlib

import pytest

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.memory import MemoryNetwork
from mart.runtime.live_services import LiveIds


def test_who_comes_is_known_and_who_goes_is_forgotten_after_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = 100.0
    monkeypatch.setattr("mart.runtime.live_services.clock.monotonic_s", lambda: now_s)
    bus = MemoryNetwork().connect()
    bus.announce(keys.alive(ServiceKind.SIM, "room-1"))
    bus.announce(keys.alive(ServiceKind.RECORDER, "recorder-1"))
    with contextlib.closing(LiveIds(bus, ServiceKind.SIM, forgotten_after_s=10.0)) as live:
        token = bus.announce(keys.alive(ServiceKind.SIM, "room-2"))
        assert [room in live for room in ("room-1", "room-2", "recorder-1")] == [True, True, False]
        token.close()
        now_s += 9.0
        assert "room-2" in live
        now_s += 2.0
        assert "room-2" not in live
        assert "room-1" in live


def test_a_token_whose_word_was_lost_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    bus = MemoryNetwork().connect()
    with contextlib.closing(LiveIds(bus, ServiceKind.SIM, forgotten_after_s=0.0)) as live:
        monkeypatch.setattr(bus, "alive", lambda _expression: [keys.alive(ServiceKind.SIM, "room-9")])
        assert "room-9" not in live
        live._ask()
        assert "room-9" in live
