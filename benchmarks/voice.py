"""What hearing and speaking take of a seat's process: at rest and while one or two speak, for each who listens.

Beside it the way in which nothing passes as it was encoded: each voice decoded, and encoded anew for each who listens,
with aiortc's own decoder and encoder.

    python benchmarks/voice.py
"""

from __future__ import annotations

import asyncio
import contextlib
import time
from fractions import Fraction

import av
import numpy as np
from aiortc.codecs.opus import OpusDecoder, OpusEncoder
from aiortc.jitterbuffer import JitterFrame
from report import Bar, report
from support.voice_seat import VoiceSeat, voice_seat

from mart.protocol.tokens import Role
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.teleop_gateway.browser import Browser
from tests.teleop_gateway.voice.tone import SAMPLES_PER_S, Tone

LISTENERS = 6
SPEAKERS = ("Ana", "Ben")
WATCHED_S, SETTLE_S = 10.0, 3.0
FRAME, FRAMES = 960, 1000


async def watched(seat: VoiceSeat) -> float:
    """Cores taken."""
    await asyncio.sleep(SETTLE_S)
    before_s, begun_s = await seat.used_s(), time.monotonic()
    await asyncio.sleep(WATCHED_S)
    return (await seat.used_s() - before_s) / (time.monotonic() - begun_s)


async def taken_with(seat: VoiceSeat, *, sound: bool) -> dict[str, float]:
    """Cores taken by so many who listen: at rest, and where they have sound also while one and two speak."""
    tones = [Tone(440.0 * (1 + number)) for number in range(LISTENERS + len(SPEAKERS) if sound else 0)]
    names = [*SPEAKERS, *[""] * LISTENERS] if sound else [""] * (LISTENERS + len(SPEAKERS))
    browsers = [Browser(Role.VIEWER, says=tones[number] if sound else None) for number in range(len(names))]
    async with contextlib.AsyncExitStack() as stack:
        for number, (name, browser) in enumerate(zip(names, browsers, strict=True)):
            stack.push_async_callback(browser.close)

            async def exchange(sdp: str, person: str = f"person-{number}", name: str = name) -> str:
                return await seat.answer(sdp, person, name)

            await browser.connect(exchange)
        taken = {"rest": await watched(seat)}
        for count, tone in zip(("one", "two"), tones, strict=False):
            tone.is_on.set()
            taken[count] = await watched(seat)
    return taken


def transcoding_s() -> float:
    """Processor time of decoding a packet of 20 ms and encoding it anew."""
    encoder, decoder, again = OpusEncoder(), OpusDecoder(), OpusEncoder()
    packets = []
    noise = np.random.default_rng(0)
    for number in range(FRAMES):
        times_s = (number * FRAME + np.arange(FRAME)) / SAMPLES_PER_S
        wave = 8000 * np.sin(2 * np.pi * 300 * times_s) + noise.normal(0, 1000, FRAME)
        frame = av.AudioFrame.from_ndarray(wave.astype(np.int16)[None, :], format="s16", layout="mono")
        frame.sample_rate, frame.pts, frame.time_base = (
            SAMPLES_PER_S,
            number * FRAME,
            Fraction(1, SAMPLES_PER_S),
        )
        packets += encoder.encode(frame)[0]
    begun_s = time.process_time()
    for number, packet in enumerate(packets):
        for decoded in decoder.decode(JitterFrame(packet, number * FRAME)):
            again.encode(decoded)
    return (time.process_time() - begun_s) / len(packets)


async def measured() -> tuple[dict[str, float], dict[str, float]]:
    router = f"tcp/127.0.0.1:{free_port()}"
    with ZenohBus.route(router):
        with voice_seat(router) as seat:
            silent = await taken_with(seat, sound=False)
        with voice_seat(router) as seat:
            return silent, await taken_with(seat, sound=True)


def main() -> None:
    silent, sound = asyncio.run(measured())
    people = LISTENERS + len(SPEAKERS)
    metrics = {
        "peers": people,
        "cores_without_sound": silent["rest"],
        "cores_at_rest": sound["rest"],
        "cores_one_speaks": sound["one"],
        "cores_two_speak": sound["two"],
        "core_share_a_listener_at_rest": (sound["rest"] - silent["rest"]) / people,
        "core_share_a_listener_of_one_voice": (sound["one"] - sound["rest"]) / (people - 1),
    }
    transcoded = transcoding_s() * SAMPLES_PER_S / FRAME
    bars = [
        Bar.at_most("core_share_a_listener_at_rest", metrics["core_share_a_listener_at_rest"], 0.002),
        Bar.at_most(
            "core_share_a_listener_of_one_voice", metrics["core_share_a_listener_of_one_voice"], 0.03
        ),
    ]
    report("voice", metrics, {"core_share_transcoding_adds_a_listener": transcoded}, bars)


if __name__ == "__main__":
    main()
