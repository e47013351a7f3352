"""Give who speaks a lane to be heard on, and every packet its time there. Pure.

A lane is one audio stream to each listener. Packets pass on it as they were encoded, so it carries one voice at a time;
the listeners' browsers put several lanes together.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

from mart.protocol.messages import VoicePacket
from mart.runtime.queueing_delay import QueueingDelay

LANES = 2  # who speaks when so many do is heard by nobody, and told so
SAMPLES_PER_S = 48_000  # of the time stamps of every Opus stream (RFC 7587, section 4.1)
SILENT_S = 0.5  # without a packet: has ended
MAX_WAITED_S = 0.2  # a packet that waited longer on its way is left out: what is said now is worth more
_MAX_SKEW = (
    SAMPLES_PER_S // 4
)  # of a packet's time against its arrival: beyond, the speaker's count began anew
_PACKET = SAMPLES_PER_S // 50
_REMEMBERED = 16


@dataclass(frozen=True)
class Speaker:
    """Name who speaks. `arm` is empty for a host."""

    name: str
    arm: str


@dataclass(frozen=True)
class LanePacket:
    """Hold a piece of speech and where it is to be heard: `time` is in samples of its lane, and never goes far back."""

    lane: int
    speaker_id: str
    time: int
    opus: bytes


class _Lane:
    def __init__(self) -> None:
        self.speaker_id = ""
        self.speaker = Speaker("", "")
        self.heard_s = -float("inf")
        self._begun_s = 0.0
        self._first_timestamp = 0
        self._first_time = self._newest_time = 0

    def is_free(self, now_s: float) -> bool:
        return now_s - self.heard_s > SILENT_S

    def time_of(self, timestamp: int, now_s: float) -> int:
        since_first = _signed(timestamp - self._first_timestamp)
        skew = since_first - int((now_s - self._begun_s) * SAMPLES_PER_S)
        if self.is_free(now_s) or abs(skew) > _MAX_SKEW:
            self._begun_s, self._first_timestamp, since_first = now_s, timestamp, 0
            self._first_time = max(int(now_s * SAMPLES_PER_S), self._newest_time + _PACKET)
        time = self._first_time + since_first
        self._newest_time = max(self._newest_time, time)
        return time


class VoiceLanes:
    """Take the packets of a room in as they come. `now_s` is of a clock that never goes back."""

    def __init__(self) -> None:
        self._lanes = [_Lane() for _ in range(LANES)]
        self._delays: OrderedDict[str, QueueingDelay] = OrderedDict()  # of the newest speakers

    def take(self, packet: VoicePacket, now_s: float) -> LanePacket | None:
        """Return where a packet is heard; None where it comes too late, or others have every lane."""
        lane = self._lane_of(packet.speaker_id, now_s)
        if lane is None or self._waited_s(packet, now_s) > MAX_WAITED_S:
            return None
        if lane.speaker_id != packet.speaker_id:
            lane.speaker_id = packet.speaker_id
            lane.heard_s = -float("inf")
        time = lane.time_of(packet.timestamp, now_s)
        lane.speaker, lane.heard_s = Speaker(packet.name, packet.arm), now_s
        return LanePacket(self._lanes.index(lane), packet.speaker_id, time, packet.opus)

    def is_full_for(self, speaker_id: str, now_s: float) -> bool:
        """Tell whether others have every lane."""
        return self._lane_of(speaker_id, now_s) is None

    def speakers(self, now_s: float) -> list[Speaker]:
        """Return who is heard now, in the order of the lanes."""
        return [lane.speaker for lane in self._lanes if not lane.is_free(now_s)]

    def _lane_of(self, speaker_id: str, now_s: float) -> _Lane | None:
        busy = (one for one in self._lanes if one.speaker_id == speaker_id and not one.is_free(now_s))
        free = (one for one in self._lanes if one.is_free(now_s))
        return next(busy, None) or next(free, None)

    def _waited_s(self, packet: VoicePacket, now_s: float) -> float:
        delay = self._delays.setdefault(packet.speaker_id, QueueingDelay())
        self._delays.move_to_end(packet.speaker_id)
        if len(self._delays) > _REMEMBERED:
            self._delays.popitem(last=False)
        return delay.waited_s(packet.sent_ns * 1e-9, now_s)


def _signed(difference: int) -> int:
    """Return a difference of two 32-bit counts that wrap, from -2^31 on."""
    return (difference + 2**31) % 2**32 - 2**31
