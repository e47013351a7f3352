"""Offer `mart gateway`, `mart camera`, `mart phone`, `mart ar-phone`. Heavy modules are imported when one runs."""

from __future__ import annotations

from typing import Any

import click

from mart.protocol.errors import InvalidInput
from mart.runtime.camera_option import cameras_option


@click.command()
@click.option("--room", help="Id of the room.  [default: room-1]")
@cameras_option
@click.option(
    "--frozen-after-s",
    type=click.FloatRange(0, 3600),
    help="After so long without a changed pixel the picture counts as frozen; 0: never.  [default: 5]",
)
def camera(*, cameras: dict[str, str], **options: Any) -> None:
    """Capture one camera of a room, beside its hardware: for seats that show it, and for the files."""
    from mart.teleop_gateway.cameras.camera_service import serve_camera
    from mart.teleop_gateway.cameras.camera_settings import CameraSettings

    if len(cameras) != 1:
        raise InvalidInput(
            f"{len(cameras)} cameras were given; give one with its source, such as --camera arm0=/dev/video0."
        )
    ((name, source),) = cameras.items()
    given = {option: value for option, value in options.items() if value is not None}
    serve_camera(CameraSettings(camera=name, source=source, **given))


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
    from mart.teleop_gateway.phones.pairing_client import PairingClient, PhonePairing, exchange_of
    from mart.teleop_gateway.settings import GatewaySettings

    async def pair() -> PhonePairing:
        async with PairingClient(url, insecure) as lobby:
            return await lobby.pair(code)

    async def drive(service: AsyncService) -> None:
        async with PairingClient(url, insecure) as lobby:

            def on_epoch(epoch: int) -> None:
                emulated.seat_epoch = epoch

            emulated = EmulatedPhone(
                service.bus,
                exchange_of(lobby, pairing, on_epoch),
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


@click.command(name="ar-phone")
@click.argument("address")
@click.option("--insecure", is_flag=True, help="Take any certificate: for one that the platform made itself.")
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="Where to listen; 0.0.0.0 lets a phone in."
)
@click.option(
    "--port", default=8888, show_default=True, type=click.IntRange(0, 65535), help="0: any free one."
)
def ar_phone(address: str, *, insecure: bool, host: str, port: int) -> None:
    """Drive with an iPhone's full motion: through the app MuJoCo AR, which follows the phone by ARKit.

    ADDRESS is what "Pair a phone" on the operator's page shows: https://…/phone#CODE.
    """
    import asyncio

    from mart.runtime.log_format import configure_logging
    from mart.teleop_gateway.arkit.drive import drive_by_app

    lobby, _, code = address.partition("/phone#")
    if not code or not lobby.startswith("https://"):
        raise click.UsageError(
            f'{address!r} was given; the address that "Pair a phone" shows is like https://mart.local:8443/phone#CODE.'
        )
    configure_logging("info", "ar-phone")
    asyncio.run(drive_by_app(lobby, code, insecure=insecure, host=host, port=port, say=click.echo))
