"""Offer `--replica`, and ask the replica that it names."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from mart.protocol.errors import Forbidden, Unavailable
from mart.recorder.settings import RecorderSettings

if TYPE_CHECKING:
    from mart.recorder.verify.replica import AskReplica

replica_option = click.option("--replica", help="Which replica re-simulates.  [default: replica-1]")


def recorder_settings(replica: str | None) -> RecorderSettings:
    """Return the recorder's settings, with the replica that was named."""
    return RecorderSettings() if replica is None else RecorderSettings(replica=replica)


@contextmanager
def resimulation(replica: str | None, *, wherever_possible: bool = False) -> Iterator[AskReplica]:
    """Ask a replica. Without a router this raises Unavailable: at once, or `wherever_possible` when it is asked."""
    from mart.recorder.verify import resimulation as verification
    from mart.runtime.bus.zenoh_bus import ZenohBus

    settings = recorder_settings(replica)
    try:
        bus = ZenohBus.connect(settings.router, wait_for_router=False)
    except (Unavailable, Forbidden) as error:
        if not wherever_possible:
            raise
        yield verification.nobody(error)
    else:
        with bus:
            yield verification.replica(bus, settings.replica)
