"""A voice of one frequency, and an ear for it."""

from __future__ import annotations

import asyncio
import fractions

import numpy as np
from aiortc import MediaStreamTrack, RTCRtpReceiver
from av import AudioFrame

from mart.protocol import clock

SAMPLES_PER_S = 48_000
_FRAME = 960


class Tone(MediaStreamTrack):
    """Sounds while `is_on` is set; then nothing is sent, as by a browser whose track was taken away."""

    kind = "audio"

    def __init__(self, frequency_hz: float = 440.0) -> None:
        super().__init__()
        self.is_on = asyncio.Event()
        self._frequency_hz = frequency_hz
        self._sample = 0
        self._due_s = 0.0

    async def recv(self) -> AudioFrame:
        await self.is_on.wait()
        self._due_s = max(self._due_s + _FRAME / SAMPLES_PER_S, clock.monotonic_s())
        await asyncio.sleep(self._due_s - clock.monotonic_s())
        times_s = np.arange(self._sample, self._sample + _FRAME) / SAMPLES_PER_S
        wave = 12_000 * np.sin(2 * np.pi * self._frequency_hz * times_s)
        frame = AudioFrame.from_ndarray(wave.astype(np.int16)[None, :], format="s16", layout="mono")
        frame.sample_rate, frame.pts = SAMPLES_PER_S, self._sample
        frame.time_base = fractions.Fraction(1, SAMPLES_PER_S)
        self._sample += _FRAME
        return frame


async def heard_hz(receiver: RTCRtpReceiver, frames: int = 15) -> float:
    """The loudest frequency of the next 20 ms frames; those before them are left out, while the decoder settles."""
    waves = []
    for _ in range(frames + 10):
        frame = await receiver.track.recv()
        assert isinstance(frame, AudioFrame)
        waves.append(frame.to_ndarray().reshape(-1, len(frame.layout.channels))[:, 0].astype(float))
    wave = np.concatenate(waves[10:])
    spectrum = np.abs(np.fft.rfft(wave * np.hanning(len(wave))))
    return float(np.argmax(spectrum) * SAMPLES_PER_S / len(wave))
