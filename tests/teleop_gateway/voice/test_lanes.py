"""Who is heard on which lane, and when each packet sounds there."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol.messages import VoicePacket
from mart.teleop_gateway.voice.lanes import LANES, MAX_WAITED_S, SAMPLES_PER_S, SILENT_S, Speaker, VoiceLanes
from mart.teleop_gateway.voice.speech_bounds import MAX_BYTES, MAX_PER_S, SpeechBounds

FRAME = SAMPLES_PER_S // 50
EARLY_NS = 10**18


def packet(who: str, number: int = 0, timestamp: int | None = None, sent_s: float = 0.0) -> VoicePacket:
    timestamp = (number * FRAME) % 2**32 if timestamp is None else timestamp
    sent_ns = EARLY_NS + int(sent_s * 1e9)
    return VoicePacket(speaker_id=who, name=who.title(), timestamp=timestamp, sent_ns=sent_ns, opus=b"x")


def test_two_who_speak_at_once_have_a_lane_each_and_a_third_has_none() -> None:
    lanes = VoiceLanes()
    heard = [lanes.take(packet(who), 10.0) for who in ("ana", "ben", "cem")]
    assert [one and one.lane for one in heard] == [0, 1, None]
    assert lanes.is_full_for("cem", 10.0)
    assert not lanes.is_full_for("ana", 10.0)
    assert lanes.speakers(10.0) == [Speaker("Ana", ""), Speaker("Ben", "")]


def test_a_lane_is_free_once_its_voice_has_ended() -> None:
    lanes = VoiceLanes()
    for who in ("ana", "ben"):
        lanes.take(packet(who), 10.0)
    later_s = 10.0 + SILENT_S + 0.01
    lanes.take(packet("ben", sent_s=SILENT_S), 10.0 + SILENT_S / 2)
    heard = lanes.take(packet("cem", sent_s=SILENT_S), later_s)
    assert heard is not None
    assert heard.lane == 0
    assert lanes.speakers(later_s) == [Speaker("Cem", ""), Speaker("Ben", "")]


def test_packets_keep_their_distances_across_the_wrap_and_out_of_order() -> None:
    lanes = VoiceLanes()
    begun = 2**32 - FRAME
    times = []
    for order in (0, 2, 1, 3):
        now_s = 5.0 + order * 0.02
        heard = lanes.take(
            packet("ana", timestamp=(begun + order * FRAME) % 2**32, sent_s=order * 0.02), now_s
        )
        assert heard is not None
        times.append(heard.time)
    assert [time - times[0] for time in times] == [0, 2 * FRAME, FRAME, 3 * FRAME]


def test_a_count_that_begins_anew_goes_on_at_the_time_of_day() -> None:
    lanes = VoiceLanes()
    first, anew = (
        lanes.take(packet("ana", timestamp=timestamp, sent_s=sent_s), 5.0 + sent_s)
        for timestamp, sent_s in ((7, 0.0), (2**31, 0.02))
    )
    assert first is not None
    assert anew is not None
    assert anew.time - first.time == pytest.approx(FRAME, abs=1)


def test_what_waited_on_its_way_is_left_out() -> None:
    lanes = VoiceLanes()
    assert lanes.take(packet("ana", 0), 5.0) is not None
    assert lanes.take(packet("ana", 1, sent_s=0.02), 5.02 + MAX_WAITED_S + 0.01) is None
    assert lanes.take(packet("ana", 20, sent_s=0.4), 5.4) is not None


@settings(max_examples=30)
@given(
    st.lists(st.tuples(st.sampled_from("abcd"), st.integers(0, 2**32 - 1), st.floats(0.0, 0.3)), max_size=60)
)
def test_no_packet_sounds_far_from_now_and_no_lane_has_two_voices(
    said: list[tuple[str, int, float]],
) -> None:
    lanes, now_s, heard_s = VoiceLanes(), 100.0, dict[int, tuple[str, float]]()
    for who, timestamp, pause_s in said:
        now_s += pause_s
        heard = lanes.take(packet(who, timestamp=timestamp, sent_s=now_s), now_s)
        if heard is None:
            continue
        assert 0 <= heard.lane < LANES
        assert heard.time >= (now_s - 0.5) * SAMPLES_PER_S
        other, last_s = heard_s.get(heard.lane, (who, now_s))
        assert other == who or now_s - last_s > SILENT_S
        heard_s[heard.lane] = who, now_s


def test_a_flood_is_cut_down_to_what_a_voice_takes() -> None:
    bounds = SpeechBounds()
    passed = sum(bounds.allow(b"x", 1.0 + number / 10_000) for number in range(10_000))
    assert passed == MAX_PER_S
    assert not bounds.allow(b"", 9.0)
    assert not bounds.allow(b"x" * (MAX_BYTES + 1), 9.0)
    assert bounds.allow(b"x" * MAX_BYTES, 9.0)
