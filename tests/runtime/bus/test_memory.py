"""The twin's faults are what its script says."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import keys
from mart.protocol.errors import InvalidInput
from mart.runtime.bus.base import Sample
from mart.runtime.bus.memory import Link, MemoryNetwork, matches

TOPIC = keys.state("room-1")


def sent_through(
    link: Link, count: int, seed: int = 0, spacing_s: float = 0.0
) -> tuple[MemoryNetwork, list[tuple[float, int]]]:
    """`count` numbered puts, `spacing_s` apart; the arrivals as (time, number)."""
    network = MemoryNetwork(link, seed)
    arrivals: list[tuple[float, int]] = []
    network.connect().subscribe(
        TOPIC.key, lambda sample: arrivals.append((network.now_s, int(sample.payload)))
    )
    publisher = network.connect().publisher(TOPIC)
    for number in range(count):
        network.advance(number * spacing_s)
        publisher.put(str(number).encode())
    network.advance(1e9)
    return network, arrivals


@given(st.floats(0.001, 1.0), st.floats(0.0, 1.0), st.integers(0, 100))
def test_every_put_arrives_within_delay_and_jitter(delay_s: float, jitter_s: float, seed: int) -> None:
    _, arrivals = sent_through(Link(delay_s, jitter_s), 20, seed)
    assert sorted(number for _, number in arrivals) == list(range(20))
    assert all(delay_s <= at_s <= delay_s + jitter_s + 1e-9 for at_s, _ in arrivals)


def test_without_jitter_order_is_kept_and_with_it_messages_overtake() -> None:
    _, steady = sent_through(Link(delay_s=0.1), 100, spacing_s=0.001)
    _, shaken = sent_through(Link(delay_s=0.1, jitter_s=0.05), 100, spacing_s=0.001)
    assert [number for _, number in steady] == list(range(100))
    assert [number for _, number in shaken] != list(range(100))


def test_loss_takes_its_share_and_repeats_with_its_seed() -> None:
    _, first = sent_through(Link(loss=0.3), 1000, seed=7)
    _, second = sent_through(Link(loss=0.3), 1000, seed=7)
    assert first == second
    assert 600 < len(first) < 800


def test_nothing_arrives_before_its_time() -> None:
    network = MemoryNetwork(Link(delay_s=0.1))
    arrived: list[Sample] = []
    network.connect().subscribe(TOPIC.key, arrived.append)
    network.connect().publisher(TOPIC).put(b"1")
    network.advance(0.0999)
    assert not arrived
    network.advance(0.1)
    assert len(arrived) == 1


@pytest.mark.parametrize("faults", [{"delay_s": -1.0}, {"jitter_s": -0.1}, {"loss": 1.5}])
def test_an_impossible_link_is_refused(faults: dict[str, float]) -> None:
    with pytest.raises(InvalidInput, match="must be"):
        Link(**faults)


@pytest.mark.parametrize(
    ("expression", "key", "expected"),
    [
        ("mart/*/state", "mart/room-1/state", True),
        ("mart/*/state", "mart/a/b/state", False),
        ("mart/*/*/x", "mart/@live/sim/x", False),
        ("mart/@live/*/*", "mart/@live/sim/room-1", True),
    ],
)
def test_key_expressions_match_as_in_zenoh(expression: str, key: str, expected: bool) -> None:
    assert matches(expression, key) is expected
