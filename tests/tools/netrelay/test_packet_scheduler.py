from __future__ import annotations

import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from tools.netrelay.impairment import PROFILES, Impairment, LinkProfile
from tools.netrelay.packet_scheduler import PacketLoss, PacketScheduler

_MS = 1_000_000
impairments = st.builds(
    Impairment,
    delay_ms=st.floats(50, 200),
    jitter_ms=st.floats(0, 50),
    loss_percent=st.floats(0, 100),
    burst=st.floats(1, 5),
    rate_kbit_s=st.sampled_from([0.0, 500.0, 8000.0]),
    stall_every_ms=st.sampled_from([0.0, 500.0]),
    stall_ms=st.floats(0, 200),
    outage_every_ms=st.sampled_from([0.0, 900.0]),
    outage_ms=st.floats(0, 300),
)


def sent(scheduler: PacketScheduler, count: int, every_ms: float = 5.0) -> list[tuple[int, int | PacketLoss]]:
    times = [round(number * every_ms * _MS) for number in range(count)]
    return [(now_ns, scheduler.schedule(now_ns, 100)) for now_ns in times]


@given(impairments, st.integers(0, 1000))
def test_nothing_arrives_early_or_out_of_order(impairment: Impairment, seed: int) -> None:
    arrived = [
        (at_ns, arrives)
        for at_ns, arrives in sent(PacketScheduler(impairment, seed), 200)
        if not isinstance(arrives, PacketLoss)
    ]
    least_ns = (impairment.delay_ms - impairment.jitter_ms) * _MS
    assert all(arrives - at_ns >= least_ns - 1 for at_ns, arrives in arrived)
    assert [arrives for _, arrives in arrived] == sorted(arrives for _, arrives in arrived)


@given(impairments, st.integers(0, 1000))
def test_the_same_seed_is_the_same_network(impairment: Impairment, seed: int) -> None:
    assert sent(PacketScheduler(impairment, seed), 50) == sent(PacketScheduler(impairment, seed), 50)


def test_delay_jitter_and_losses_are_as_set() -> None:
    packets = sent(PacketScheduler(PROFILES["intercontinental"].up, 3), 20_000)
    delays_ms = [(arrives - at_ns) / _MS for at_ns, arrives in packets if not isinstance(arrives, PacketLoss)]
    assert statistics.mean(delays_ms) == pytest.approx(151, abs=2)
    assert statistics.stdev(delays_ms) == pytest.approx(17.3, abs=1)  # 30 / sqrt(3)
    assert len(delays_ms) / len(packets) == pytest.approx(0.99, abs=0.003)


def test_losses_come_in_bursts() -> None:
    outcomes = sent(PacketScheduler(Impairment(loss_percent=5, burst=4), 1), 40_000)
    lost = [isinstance(arrives, PacketLoss) for _, arrives in outcomes]
    bursts = sum(now and not before for before, now in zip([False, *lost], lost, strict=False))
    assert sum(lost) / bursts == pytest.approx(4, rel=0.15)


def test_an_outage_loses_and_a_stall_holds() -> None:
    scheduler = PacketScheduler(Impairment(delay_ms=10), 0)
    scheduler.interrupt(0, outage_s=1.0)
    assert scheduler.schedule(999 * _MS, 100) is PacketLoss.OUTAGE
    assert scheduler.schedule(1000 * _MS, 100) == 1010 * _MS
    scheduler.interrupt(1100 * _MS, stall_s=2.0)
    assert scheduler.schedule(1200 * _MS, 100) == 3100 * _MS


def test_outages_come_back() -> None:
    scheduler = PacketScheduler(PROFILES["outage"].up, 0)
    dark = [at_ns for at_ns, arrives in sent(scheduler, 8000) if arrives is PacketLoss.OUTAGE]
    assert dark[0] == 18_000 * _MS
    assert len(dark) == 2 * 2000 / 5


def test_a_narrow_link_delays_and_then_loses() -> None:
    scheduler = PacketScheduler(Impairment(rate_kbit_s=800, queue_ms=20), 0)
    outcomes = [scheduler.schedule(0, 1000) for _ in range(5)]  # 10 ms each
    assert outcomes == [10 * _MS, 20 * _MS, 30 * _MS, PacketLoss.QUEUE, PacketLoss.QUEUE]


def test_settings_change_one_direction_or_both() -> None:
    profile = LinkProfile().changed(["delay_ms=150", "up.loss_percent=3", "jitter_ms=30"])
    assert (profile.up.delay_ms, profile.down.delay_ms, profile.down.jitter_ms) == (150, 150, 30)
    assert (profile.up.loss_percent, profile.down.loss_percent) == (3, 0)


@pytest.mark.parametrize(
    "setting",
    ["delay", "delay_ms", "delay_ms=", "left.delay_ms=1", "speed=3", "delay_ms=-1", "loss_percent=101",
     "burst=0.5", "jitter_ms=1", "delay_ms=nan"],
)  # fmt: skip
def test_what_cannot_be_set_is_refused(setting: str) -> None:
    with pytest.raises(InvalidInput):
        LinkProfile().changed([setting])
