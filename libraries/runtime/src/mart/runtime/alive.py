"""`mart alive`: the health check of every container."""

from __future__ import annotations

import click

from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.cli import json_option, print_result


@click.command()
@click.argument("kind", type=click.Choice([kind.value for kind in ServiceKind]))
@click.argument("id", required=False)
@json_option
def alive(kind: str, id: str | None, as_json: bool) -> None:
    """Tell whether a service of this KIND is alive, for health checks."""
    from mart.protocol import keys
    from mart.runtime.bus.zenoh_bus import ZenohBus
    from mart.runtime.settings import Settings

    with ZenohBus.connect(Settings().router, wait_for_router=False) as bus:
        found = bus.alive(keys.alive(ServiceKind(kind), id) if id else keys.alive_of(ServiceKind(kind)))
    if not found:
        raise Unavailable(f"No {kind}{f' {id}' if id else ''} is alive; start it with `mart {kind}`.")
    ids = [keys.last_of(key) for key in found]
    print_result({"kind": kind, "ids": ids}, f"{kind}: {', '.join(ids)}", as_json)
