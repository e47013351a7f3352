"""What people say to each other is heard, and never recorded."""

from __future__ import annotations

from contextlib import closing

from mart.protocol import codec, keys
from mart.protocol.messages import RoomStatus, VoicePacket
from mart.recorder.record.inbox import Inbox, RoomSubscriptions
from mart.runtime.bus.memory import MemoryNetwork


def test_the_recorder_does_not_hear_voices() -> None:
    network, inbox = MemoryNetwork(), Inbox()
    bus = network.connect()
    with closing(RoomSubscriptions(network.connect(), network.connect(), inbox)):
        bus.publisher(keys.voice("room-1", "arm0")).put(codec.encode(VoicePacket(room="room-1", opus=b"x")))
        bus.publisher(keys.status("room-1")).put(codec.encode(RoomStatus(room="room-1")))
        taken = inbox.take(timeout_s=0.1)
    assert [arrival.key for arrival in taken.arrivals] == [keys.status("room-1").key]
