"""A name on the local network, answered for by the real responder; where there is no network, nothing is missed."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Sequence

import pytest
from zeroconf import AddressResolverIPv4  # type: ignore[attr-defined]  # not in its __all__
from zeroconf.asyncio import AsyncZeroconf

from mart.runtime.ports import free_port
from mart.web.access import site_names
from mart.web.access.site_names import SiteNames
from mart.web.app import mdns_announcement
from mart.web.app.mdns_announcement import keep_announced, mdns_names

pytestmark = pytest.mark.anyio

OWN = "127.0.0.1"


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(autouse=True)
def _on_the_loopback(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (site_names, mdns_announcement):
        monkeypatch.setattr(module, "lan_addresses", lambda: (OWN,))


@contextlib.asynccontextmanager
async def announced(name: str) -> AsyncIterator[SiteNames]:
    site, settled = SiteNames((), "0.0.0.0"), asyncio.Event()
    task = asyncio.ensure_future(keep_announced(name, free_port(), site, settled))
    try:
        async with asyncio.timeout(20):
            await settled.wait()
        yield site
    finally:
        task.cancel()
        await asyncio.wait([task])


def test_names_alike_are_counted() -> None:
    assert mdns_names("lab")[:3] == ["lab.local", "lab-2.local", "lab-3.local"]


async def test_the_name_is_answered_for_and_the_site_goes_by_it() -> None:
    async with announced("mart-test-one") as site:
        assert "mart-test-one.local" in site.names
        assert "https://mart-test-one.local:8443/" in site.urls_for_others("localhost:8443")
        asking = AsyncZeroconf(interfaces=[OWN])
        resolver = AddressResolverIPv4("mart-test-one.local.")
        assert await resolver.async_request(asking.zeroconf, 5000)
        assert resolver.parsed_addresses() == [OWN]
        await asking.async_close()
    assert site.mdns_host == ""


async def test_a_name_that_is_taken_gets_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = ["mart-test-two.local.", "mart-test-two-2.local."]

    async def request(resolver: AddressResolverIPv4, *_: object) -> bool:
        return resolver.name in taken

    def somebody_else(_resolver: AddressResolverIPv4) -> Sequence[str]:
        return ["192.0.2.9"]

    class Resolver:
        def __init__(self, name: str) -> None:
            self.name = name

        async_request = request
        parsed_addresses = somebody_else

    monkeypatch.setattr("zeroconf.AddressResolverIPv4", Resolver)
    async with announced("mart-test-two") as site:
        assert site.mdns_host == "mart-test-two-3.local"


async def test_without_a_way_to_announce_the_site_goes_by_its_addresses(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(**_: object) -> None:
        raise OSError("no multicast here")

    monkeypatch.setattr(mdns_announcement, "AsyncZeroconf", fail)
    async with announced("mart-test-three") as site:
        assert site.mdns_host == ""
