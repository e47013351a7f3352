"""Answer for a name of our own on the local network (multicast DNS, RFC 6762), so that people type `mart.local`.

Nothing depends on it: where it does not work, the site goes by its addresses, and the log says why.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Sequence

import zeroconf
from zeroconf import Error, IPVersion
from zeroconf.asyncio import AsyncServiceInfo, AsyncZeroconf

from mart.runtime.lan_addresses import lan_addresses
from mart.web.access.site_names import SiteNames

_log = logging.getLogger(__name__)

LOOK_EVERY_S = 30.0
_ANSWER_MS = 500  # whoever has a name answers within 250 ms
_END_TIMEOUT_S = 2.0
_MAX_ALIKE = 9
_KIND = "_https._tcp.local."


def mdns_names(name: str) -> list[str]:
    """Return the names to be tried, the wanted one first: mart.local, mart-2.local, …"""
    return [f"{name}{f'-{number}' if number > 1 else ''}.local" for number in range(1, _MAX_ALIKE + 1)]


async def keep_announced(name: str, port: int, site: SiteNames, settled: asyncio.Event) -> None:
    """Answer for `name`.local, or for name-2.local where another machine has that, until cancelled.

    `site` is told the name; `settled` is set as soon as it is known, or known not to work. A laptop that moves to
    another network is announced there within half a minute. Raises nothing but a cancellation.
    """
    told = ""
    while True:
        try:
            async with contextlib.AsyncExitStack() as stack:
                addresses = lan_addresses()
                if addresses:
                    site.mdns_host = await _announce(name, port, addresses, stack)
                    site.look()
                    _log.info("This site is also called %s on the local network", site.mdns_host)
                settled.set()
                await _moved(addresses)
        except (OSError, Error, TimeoutError) as error:
            if told != str(error):
                _log.warning("No name on the local network (mDNS): %s.", str(error) or type(error).__name__)
            told = str(error)
            settled.set()
            await asyncio.sleep(LOOK_EVERY_S)
        finally:
            site.mdns_host = ""


async def _moved(addresses: Sequence[str]) -> None:
    """Return when this machine has other addresses than these. Nothing tells: it is asked."""
    while addresses == lan_addresses():  # noqa: ASYNC110
        await asyncio.sleep(LOOK_EVERY_S)


async def _announce(name: str, port: int, addresses: Sequence[str], stack: contextlib.AsyncExitStack) -> str:
    """Return the name that is answered for from now on, until `stack` ends."""
    responder = AsyncZeroconf(interfaces=list(addresses), ip_version=IPVersion.V4Only)
    stack.push_async_callback(_close, responder)
    host = await _free_name(responder, name, addresses)
    service = AsyncServiceInfo(
        _KIND,
        f"MART at {host.removesuffix('.local')}.{_KIND}",
        port=port,
        server=f"{host}.",
        parsed_addresses=list(addresses),
    )
    await (await responder.async_register_service(service, allow_name_change=True))
    return host


async def _free_name(responder: AsyncZeroconf, name: str, own: Sequence[str]) -> str:
    """Return the first name that nobody else answers for. Raises OSError where all are taken."""
    for host in mdns_names(name):
        resolver = zeroconf.AddressResolverIPv4(f"{host}.")  # type: ignore[attr-defined]  # not in its __all__
        found = await resolver.async_request(responder.zeroconf, _ANSWER_MS)
        if not found or set(resolver.parsed_addresses()) <= set(own):
            return host
    raise OSError(f"{name}.local and {_MAX_ALIKE - 1} names like it are taken")


async def _close(responder: AsyncZeroconf) -> None:
    """Say goodbye, within a bounded time."""
    with contextlib.suppress(OSError, Error, TimeoutError):
        async with asyncio.timeout(_END_TIMEOUT_S):
            await responder.async_unregister_all_services()
            await responder.async_close()
