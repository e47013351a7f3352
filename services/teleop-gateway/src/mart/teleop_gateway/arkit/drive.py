"""Drive a seat by the app MuJoCo AR: paired as a phone is, with the same tokens and the same checks of every frame."""

from __future__ import annotations

from collections.abc import Callable

from mart.runtime.lan_addresses import lan_addresses
from mart.teleop_gateway.arkit.ar_phone import ARPhone
from mart.teleop_gateway.arkit.ar_receiver import ARReceiver
from mart.teleop_gateway.input.phone_frame import PhoneFrame
from mart.teleop_gateway.phones.pairing_client import PairingClient, exchange_of
from mart.teleop_gateway.phones.phone_connection import Exchange, PhoneConnection, now_us

_EVERY_ADDRESS = ("0.0.0.0", "::")  # noqa: S104  (only when asked for)


async def drive_by_app(
    url: str, code: str, *, insecure: bool, host: str, port: int, say: Callable[[str], None]
) -> None:
    """Listen at host:port and drive until cancelled, or until another phone drives; `say` tells a person what to do.

    Raises what the lobby answers to the pairing code, and Unavailable where nothing can listen.
    """
    receiver = ARReceiver()
    async with PairingClient(url, insecure) as lobby, await receiver.listen(host, port) as server:
        pairing = await lobby.pair(code)
        phone = ARPhone(pairing.epoch)

        def on_epoch(epoch: int) -> None:
            phone.seat_epoch = epoch

        say(f"This drives {pairing.arm} in {pairing.room} for {pairing.name}.")
        say(_what_to_do(host, next(iter(server.sockets)).getsockname()[1]))
        await connection_of(pairing.arm, receiver, phone, exchange_of(lobby, pairing, on_epoch)).run()
        say("Another phone drives now.")


def connection_of(arm: str, receiver: ARReceiver, phone: ARPhone, exchange: Exchange) -> PhoneConnection:
    """Return the connection that sends the newest of what the app says, at its own pace."""

    def next_frame(now_s: float, _since_s: float) -> PhoneFrame:
        return phone.frame(receiver.newest, receiver.heard_s, now_s, now_us())

    return PhoneConnection(arm, exchange, next_frame, on_told=phone.on_told)


def _what_to_do(host: str, port: int) -> str:
    addresses = lan_addresses() if host in _EVERY_ADDRESS else (host,)
    where = f"Give the app MuJoCo AR the address {' or '.join(addresses) or host} and the port {port}."
    if host.startswith("127."):
        where += " Only this machine reaches that: with --host 0.0.0.0 a phone does, and whoever is on its network."
    return where
