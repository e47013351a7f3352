"""Offer `mart gateway` and `mart phone`. Heavy modules are imported when a command runs."""

from __future__ import annotations

import click


@click.command()
@click.option(
    "--name", default="gateway-1", show_default=True, help="What this gateway is called on the bus."
)
def gateway(name: str) -> None:
    """Run a gateway: one process for each seat that a person holds."""
    from mart.protocol.vocabulary import ServiceKind
    from mart.runtime.service import AsyncService, announced, run_async
    from mart.teleop_gateway.gateway import Gateway
    from mart.teleop_gateway.settings import GatewaySettings

    settings = GatewaySettings()

    async def serve(service: AsyncService) -> None:
        with announced(service):
            await Gateway(service.bus, name, settings).run()

    run_async(settings, ServiceKind.GATEWAY, name, serve)


@click.command()
@click.option("--url", default="https://127.0.0.1:8443", show_default=True, help="The lobby's address.")
@click.option("--code", required=True, help="The pairing code that the operator page shows.")
@click.option("--insecure", is_flag=True, help="Take any certificate: for one that the platform made itself.")
@click.option("--delay-ms", default=0.0, help="Added to every message, each way.")
@click.option("--jitter-ms", default=0.0, help="At most this much more, at random.")
@click.option("--loss-percent", type=click.FloatRange(0, 100), default=0.0, help="Messages lost, each way.")
def phone(
    url: str, code: str, *, insecure: bool, delay_ms: float, jitter_ms: float, loss_percent: float
) -> None:
    """Run an emulated phone, led by the intents of `mart experts --intent`."""
    import asyncio

    from mart.protocol.vocabulary import ServiceKind
    from mart.runtime.service import AsyncService, announced, run_async
    from mart.teleop_gateway.emulation.emulated_phone import EmulatedPhone
    from mart.teleop_gateway.emulation.network_emulation import LinkProfile
    from mart.teleop_gateway.emulation.pairing_client import PairingClient, PhonePairing
    from mart.teleop_gateway.settings import GatewaySettings

    async def pair() -> PhonePairing:
        async with PairingClient(url, insecure) as lobby:
            return await lobby.pair(code)

    async def drive(service: AsyncService) -> None:
        async with PairingClient(url, insecure) as lobby:

            async def exchange(sdp: str) -> str:
                renewed = await lobby.renew(pairing)
                emulated.seat_epoch = renewed.epoch
                return await lobby.offer(renewed, sdp)

            emulated = EmulatedPhone(
                service.bus,
                exchange,
                room=pairing.room,
                arm=pairing.arm,
                seat_epoch=pairing.epoch,
                link=LinkProfile(delay_ms / 1e3, jitter_ms / 1e3, loss_percent / 1e2),
                scale=settings.hand_scale,
            )
            with announced(service):
                await emulated.run()

    settings = GatewaySettings()
    pairing = asyncio.run(pair())
    run_async(settings, ServiceKind.PHONE, f"{pairing.room}-{pairing.arm}", drive)
