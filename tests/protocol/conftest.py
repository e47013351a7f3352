"""A real router for the tests that want one."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from mart.protocol.bus.zenoh_bus import ZenohBus
from tests.support.processes import free_port


@pytest.fixture
def endpoint() -> Iterator[str]:
    address = f"tcp/127.0.0.1:{free_port()}"
    with ZenohBus.route(address):
        yield address
