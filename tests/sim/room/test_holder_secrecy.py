"""What a room says to everybody never names a holder's id: who knows it may leave the seat in that name."""

from __future__ import annotations

from mart.protocol import codec
from mart.protocol.messages import OPERATOR_HUMAN, SeatRequest
from mart.sim.world import World
from tests.sim.room.room_harness import ARMS, RoomHarness

SECRET = "5e1f0c7e5e1f0c7e"


def test_nobody_hears_a_holders_id() -> None:
    harness = RoomHarness(World.build("two_arm_multi_cube_lifting"))
    claim = SeatRequest.Claim(arm="arm0", holder_id=SECRET, name="Ana", operator=OPERATOR_HUMAN)
    reply = harness.room.answer_seat(SeatRequest(claim=claim), harness.now_s)
    harness.take(ARMS[1])
    harness.room.advance(harness.now_s)
    said = [reply, harness.room.status(harness.now_s)]
    said += [*harness.publisher.events, *harness.publisher.statuses, *harness.publisher.states]
    assert reply.seat.holder_tag
    assert any(event.HasField("seat_changed") for event in harness.publisher.events)
    assert not [message for message in said if SECRET.encode() in codec.encode(message)]
