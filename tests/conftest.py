"""What holds for every test: no MART_ setting from outside, and slow kinds last."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port

# A broken unit explains a broken session, so units run first.
_LAST = ("system", "browser", "compose")


def pytest_configure() -> None:
    # How long one example takes says more about the machine than about the code.
    settings.register_profile("mart", deadline=None)
    settings.load_profile("mart")
    for name in [name for name in os.environ if name.startswith("MART_")]:
        del os.environ[name]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    def rank(item: pytest.Item) -> int:
        folder = item.path.relative_to(config.rootpath / "tests").parts[0]
        return _LAST.index(folder) + 1 if folder in _LAST else 0

    items.sort(key=rank)


@pytest.fixture
def endpoint() -> Iterator[str]:
    """A real router of the test's own."""
    address = f"tcp/127.0.0.1:{free_port()}"
    with ZenohBus.route(address):
        yield address
