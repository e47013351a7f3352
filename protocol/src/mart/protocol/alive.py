"""`mart alive`: the health check of every container."""

from __future__ import annotations

import click

from mart.protocol.cli import json_option, print_result
from mart.protocol.errors import Unavailable


@click.command()
@click.argument("kind")
@click.argument("id", required=False)
@json_option
def alive(kind: str, id: str | None, as_json: bool) -> None:
    """Tell whether a service is alive, for health checks: KIND is sim, replica, gateway, recorder, web, …"""
    from mart.protocol import keys
    from mart.protocol.bus.zenoh_bus import ZenohBus
    from mart.protocol.settings import Settings

    with ZenohBus.connect(Settings().router, wait_for_router=False) as bus:
        found = bus.alive(keys.alive(kind, id) if id else keys.alive_of(kind))
    if not found:
        raise Unavailable(f"No {kind}{f' {id}' if id else ''} is alive; start it with `mart {kind}`.")
    ids = [keys.last_of(key) for key in found]
    print_result({"kind": kind, "ids": ids}, f"{kind}: {', '.join(ids)}", as_json)
