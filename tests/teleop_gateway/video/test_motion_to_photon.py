"""Motion to photon adds up, and counts nothing twice and nothing untrue."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import ArmState, Command, CommandStamps, State, TickStamps
from mart.teleop_gateway.video.motion_to_photon import STAGES, MotionToPhoton, PageDraws, PictureStamps

MS = 1_000_000
START_NS = 1_800_000_000_000_000_000
HZ = 20.0


def command(sequence: int, at_ns: int, waits_ms: list[int]) -> Command:
    stamps = CommandStamps(input_sent_ns=at_ns, gateway_received_ns=at_ns + MS * waits_ms[0])
    return Command(arm="arm0", sequence=sequence, stamps=stamps)


def state(tick: int, at_ns: int, waits_ms: list[int], *, fresh: bool = True) -> State:
    """The tick uses the command whose sequence is the tick's number."""
    arrived, fired, stepped = (at_ns + MS * sum(waits_ms[:i]) for i in range(2, 5))
    arm = ArmState(arm="arm0", fresh=fresh, arrived_ns=arrived, sequence=tick)
    return State(
        tick=tick,
        arms=[ArmState(arm="arm1"), arm],
        stamps=TickStamps(due_ns=fired, fired_ns=fired, stepped_ns=stepped),
    )


def command_and_state(latency: MotionToPhoton, tick: int, at_ns: int, waits_ms: list[int]) -> None:
    latency.on_command(command(tick, at_ns, waits_ms))
    latency.on_state(state(tick, at_ns, waits_ms), HZ)


def pass_through(latency: MotionToPhoton, tick: int, at_ns: int, waits_ms: list[int]) -> bool:
    command_and_state(latency, tick, at_ns, waits_ms)
    came, drawn, encoded, displayed = (at_ns + MS * sum(waits_ms[:i]) for i in range(5, 9))
    latency.on_picture(tick, PictureStamps(came, drawn, encoded))
    return latency.on_seen(tick, displayed)


@given(st.lists(st.lists(st.integers(0, 40), min_size=8, max_size=8), min_size=1, max_size=20))
def test_the_stages_of_each_report_add_up(reports: list[list[int]]) -> None:
    latency = MotionToPhoton("arm0")
    for tick, waits_ms in enumerate(reports, start=1):
        assert pass_through(latency, tick, START_NS + tick * 50 * MS, waits_ms)
    summary = latency.summary()
    assert summary is not None
    assert summary.frames == latency.reports == len(reports)
    totals = sorted(map(sum, reports))
    assert totals[0] <= summary.p50_ms <= summary.p95_ms <= totals[-1]
    if len(reports) == 1:
        assert summary.stages == pytest.approx([float(ms) for ms in reports[0]])
        assert summary.p50_ms == pytest.approx(sum(reports[0]))


def test_frames_that_were_overtaken_before_the_tick_count_too() -> None:
    latency = MotionToPhoton("arm0")
    waits_ms = [1, 2, 3, 4, 5, 6, 7, 8]
    for number, earlier_ms in ((1, 32), (2, 16)):
        latency.on_command(command(number, START_NS - earlier_ms * MS, waits_ms))
    assert pass_through(latency, 3, START_NS, waits_ms)
    summary = latency.summary()
    assert summary is not None
    assert summary.frames == 1
    assert summary.p50_ms == pytest.approx(sum(waits_ms) + 16)
    assert summary.stages == pytest.approx([1, 2, 3 + 16, 4, 5, 6, 7, 8])  # they wait for the tick
    assert pass_through(latency, 4, START_NS + 50 * MS, waits_ms)
    again = latency.summary()
    assert again is not None
    assert again.p50_ms == pytest.approx(sum(waits_ms) + 8)  # of 36, 36, 52 and 68 ms: each frame counts once


def test_frames_that_waited_while_the_world_stood_still_do_not_count() -> None:
    latency = MotionToPhoton("arm0")
    latency.on_command(command(1, START_NS - 2000 * MS, [1] * 8))
    assert pass_through(latency, 2, START_NS, [1] * 8)
    summary = latency.summary()
    assert summary is not None
    assert summary.p95_ms == 8.0


def test_only_the_newest_reports_count() -> None:
    latency = MotionToPhoton("arm0", window=10)
    for tick in range(1, 31):
        pass_through(latency, tick, START_NS + tick * 50 * MS, [tick] * 8)
    summary = latency.summary()
    assert summary is not None
    assert (summary.frames, latency.reports) == (10, 30)
    assert summary.p50_ms > 8 * 20


def test_a_tick_is_reported_once() -> None:
    latency = MotionToPhoton("arm0")
    assert pass_through(latency, 1, START_NS, [5] * 8)
    assert not latency.on_seen(1, START_NS + 100 * MS)


def test_a_picture_that_was_sent_again_is_not_counted() -> None:
    latency = MotionToPhoton("arm0")
    command_and_state(latency, 1, START_NS, [5] * 5)
    stamps = PictureStamps(START_NS + 30 * MS, START_NS + 35 * MS, START_NS + 40 * MS)
    latency.on_picture(1, stamps)
    latency.on_picture(1, stamps)
    assert not latency.on_seen(1, START_NS + 540 * MS)


@pytest.mark.parametrize(
    "lie",
    [START_NS, START_NS + 11_000 * MS, 0, -1, 10**30],
    ids=["early", "late", "zero", "negative", "huge"],
)
def test_what_cannot_be_true_is_not_counted(lie: int) -> None:
    latency = MotionToPhoton("arm0")
    command_and_state(latency, 1, START_NS, [5] * 5)
    latency.on_picture(1, PictureStamps(START_NS + 30 * MS, START_NS + 35 * MS, START_NS + 40 * MS))
    assert not latency.on_seen(1, lie)
    assert latency.summary() is None


def test_unknown_ticks_held_arms_and_unstamped_commands_have_no_account() -> None:
    latency = MotionToPhoton("arm0")
    assert not latency.on_seen(99, START_NS)
    latency.on_command(command(1, START_NS, [5] * 5))
    latency.on_command(Command(arm="arm0", sequence=2))
    for tick, fresh in ((1, False), (2, True)):
        latency.on_state(state(tick, START_NS, [5] * 5, fresh=fresh), HZ)
        latency.on_picture(tick, PictureStamps(START_NS, START_NS, START_NS))
        assert not latency.on_seen(tick, START_NS + 50 * MS)


def test_it_forgets_old_ticks() -> None:
    latency = MotionToPhoton("arm0", ticks=16)
    for tick in range(1, 100):
        command_and_state(latency, tick, START_NS, [5] * 5)
        latency.on_picture(tick, PictureStamps(START_NS, START_NS, START_NS))
    assert not latency.on_seen(1, START_NS + 50 * MS)
    assert latency.on_seen(99, START_NS + 50 * MS)


def test_the_event_names_every_stage() -> None:
    latency = MotionToPhoton("arm0")
    pass_through(latency, 1, START_NS, [1, 2, 3, 4, 5, 6, 7, 8])
    summary = latency.summary()
    assert summary is not None
    event = summary.event("arm0", PageDraws(on=True, p50_ms=3.0, p95_ms=5.0, per_s=60.0))
    assert [(s.name, s.p50_ms) for s in event.stages] == [(name, i) for i, name in enumerate(STAGES, start=1)]
    assert (event.arm, event.p50_ms, event.p95_ms, event.frames) == ("arm0", 36, 36, 1)
    assert (event.drawn_in_page, event.draw_p50_ms, event.draw_p95_ms, event.draws_per_s) == (True, 3, 5, 60)
    assert "tick wait 3.0" in str(summary)
