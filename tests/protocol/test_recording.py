"""Every metadata record reads back as it was written, and refuses what it is not."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import Corrupt
from mart.protocol.recording import CadenceRecord, EpisodeRecord, OperatorsRecord, Shift, VerificationRecord
from mart.protocol.vocabulary import Verdict

_words = st.text(st.characters(exclude_categories=["Cs"]), max_size=40)
_arms = st.sampled_from(["arm0", "arm1", "arm2", "arm10"])
_counts = st.integers(min_value=0, max_value=2**32 - 1)
_ticks = st.integers(min_value=0, max_value=2**63 - 1)
_reals = st.floats(min_value=-1e15, max_value=1e15)
_rates = st.floats(min_value=1e-3, max_value=1e5)
_per_arm = st.dictionaries(_arms, _reals)

_episodes = st.builds(
    EpisodeRecord,
    room=_words,
    number=_counts,
    task=st.none() | _words,
    control_hz=st.none() | _rates,
    arms=st.lists(_arms, unique=True).map(tuple),
    seed=st.none() | st.integers(min_value=0, max_value=2**64 - 1),
    started_ns=_ticks,
    ended_ns=_ticks,
    ticks=_counts,
    first_tick=_ticks,
    last_tick=_ticks,
    outcome=st.sampled_from(["success", "failure", "discarded", "unspecified"]),
    reason=_words,
    interrupted=st.booleans(),
    complete=st.booleans(),
    repaired=st.booleans(),
)
_cadences = st.builds(
    CadenceRecord,
    real_time_factor=st.none() | _reals,
    wall_s=_reals,
    sim_s=_reals,
    missing_ticks=_counts,
    waited_s=_reals,
    tick_interval_p50_ms=st.none() | _reals,
    video_dropped=_counts,
    messages_lost=_counts,
    waited_for_s=_per_arm,
    motion_to_photon_p50_ms=_per_arm,
    motion_to_photon_p95_ms=_per_arm,
)
_shifts = st.builds(
    Shift,
    episode_tick=st.integers(min_value=0, max_value=2**32 - 1),
    operator=st.sampled_from(["human", "policy", "script", "hold", "generated"]),
    name=_words,
)
_operators = st.builds(
    OperatorsRecord, shifts=st.dictionaries(_arms, st.lists(_shifts, min_size=1, max_size=4).map(tuple))
)


@given(_episodes)
def test_an_episode_record_reads_back(record: EpisodeRecord) -> None:
    strings = record.to_strings()
    assert all(isinstance(value, str) for value in strings.values())
    assert EpisodeRecord.from_strings(strings) == record


@given(_cadences)
def test_a_cadence_record_reads_back(record: CadenceRecord) -> None:
    assert CadenceRecord.from_strings(record.to_strings()) == record


@given(_operators)
def test_an_operators_record_reads_back(record: OperatorsRecord) -> None:
    assert OperatorsRecord.from_strings(record.to_strings()) == record


@given(verdict=st.sampled_from(Verdict), detail=_words, sha=st.none() | _words)
def test_a_verification_record_reads_back(verdict: Verdict, detail: str, sha: str | None) -> None:
    record = VerificationRecord(verdict=verdict, detail=detail, model_sha256=sha)
    assert VerificationRecord.from_strings(record.to_strings()) == record


def test_the_strings_are_those_of_the_specification() -> None:
    cadence = CadenceRecord(
        wall_s=15.0, sim_s=14.7, missing_ticks=0, waited_s=0.25, waited_for_s={"arm1": 0.25}
    )
    assert cadence.to_strings()["waited_for_arm1_s"] == "0.25"
    shifts = (Shift(episode_tick=0, operator="human", name="Ana"), Shift(episode_tick=57, operator="hold"))
    assert OperatorsRecord(shifts={"arm0": shifts}).to_strings() == {"arm0": "human Ana | tick 57: hold"}


def test_a_name_cannot_pose_as_a_shift() -> None:
    shift = Shift(episode_tick=0, operator="human", name="Ana | tick 3: policy")
    record = OperatorsRecord(shifts={"arm0": (shift,)})
    assert len(OperatorsRecord.from_strings(record.to_strings()).shifts["arm0"]) == 1


@pytest.mark.parametrize(
    "change",
    [{"ticks": "many"}, {"complete": "perhaps"}, {"control_hz": "nan"}, {"room": None}],
    ids=["number", "truth", "finite", "missing"],
)
def test_a_bad_value_is_named(change: dict[str, str | None]) -> None:
    good = EpisodeRecord(
        room="room-1", number=1, arms=("arm0",), started_ns=1, ended_ns=2, ticks=1, first_tick=0, last_tick=1,
        outcome="success", reason="", interrupted=False, complete=True,
    ).to_strings()  # fmt: skip
    bad = {key: value for key, value in (good | change).items() if value is not None}
    with pytest.raises(Corrupt, match=next(iter(change))):
        EpisodeRecord.from_strings(bad)


def test_a_bad_operator_is_refused() -> None:
    with pytest.raises(Corrupt, match="no operator"):
        OperatorsRecord.from_strings({"arm0": "??"})
