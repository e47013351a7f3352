"""Verdicts: what follows bit for bit, what differs, and what nobody can say."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt
from mart.protocol.keys import alive, rollout
from mart.protocol.messages import Error, RolloutReply, RolloutRequest, State
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import ServiceKind, Verdict
from mart.recorder.verify.replica import AskReplica, replica
from mart.recorder.verify.resimulation import compare, verify
from mart.recorder.verify.stretches import stretches
from mart.runtime.bus.memory import MemoryNetwork
from tests.recorder import synthetic
from tests.recorder.files import write_part
from tests.support.deaf_bus import DeafBus, DistantBus

_BEFORE_FINGERPRINTS = RoomRecord(
    room=synthetic.ROOM, task=synthetic.TASK, control_hz=20.0, model_sha256=synthetic.MODEL.sha256
)
_REPLICA = synthetic.ToyReplica()
_ROOM = _BEFORE_FINGERPRINTS.with_numerics(synthetic.NUMERICS)


def recorded(root: Path, states: list[State]) -> EpisodeFile:
    file, _, _ = write_part(root, states)
    file.flush()
    file.abandon()
    return EpisodeFile(file.path, {})


def verdict(
    root: Path, states: list[State], room: RoomRecord = _ROOM, ask: AskReplica = _REPLICA
) -> VerificationRecord:
    return verify(recorded(root, states), room, ask)


def test_an_episode_follows_bit_for_bit(tmp_path: Path) -> None:
    said = verdict(tmp_path, synthetic.states(30))
    assert (said.verdict, said.detail) == (Verdict.VERIFIED, "30 ticks re-simulated bit for bit.")
    assert said.model_sha256 == synthetic.MODEL.sha256


def test_what_drivers_measured_is_real_and_not_stepped_again(tmp_path: Path) -> None:
    states = synthetic.states(30)
    for state in states:
        state.arms[1].measured = True
    said = verdict(tmp_path, states, ask=_never)
    assert said.verdict is Verdict.REAL
    assert "arm1" in said.detail
    assert not said.pending


def _never(_request: RolloutRequest) -> RolloutReply:
    raise AssertionError("a replica was asked")


def test_one_bit_is_enough_to_differ(tmp_path: Path) -> None:
    states = synthetic.states(30)
    world = bytearray(states[17].integration_state)
    world[-1] ^= 1
    states[17].integration_state = bytes(world)
    said = verdict(tmp_path, states)
    assert said.verdict is Verdict.DIVERGED
    assert said.detail.startswith("Re-simulation differs from tick 17 on.")
    assert (said.first_different_tick, said.within_tolerance) == (17, False)
    assert said.largest_difference == {"positions": 1.0, "velocities": 1.0, "warm_start": 1.0}


def test_an_action_that_was_not_applied_differs(tmp_path: Path) -> None:
    states = synthetic.states(30)
    states[9].arms[1].action[0] += 1e-12
    assert "tick 9" in verdict(tmp_path, states).detail


def test_a_model_with_one_spoilt_bit_is_never_verified(tmp_path: Path) -> None:
    file = recorded(tmp_path, synthetic.states(5))
    data = bytearray(file.path.read_bytes())
    data[data.index(synthetic.MJB)] ^= 1
    file.path.write_bytes(data)
    said = verify(file, _ROOM, synthetic.ToyReplica())
    assert said.verdict is Verdict.UNVERIFIED
    assert "model.mjb" in said.detail


def on(fingerprint: str, native: str, differs_by: float = 1e-9) -> synthetic.ToyReplica:
    """A replica on a processor where nothing follows that was recorded on another."""
    return synthetic.ToyReplica(fingerprint, native, ("aa",), differs_by)


def test_on_another_processor_it_is_unverified_with_the_difference(tmp_path: Path) -> None:
    said = verdict(tmp_path, synthetic.states(30), ask=on("cc", "dd"))
    assert (said.verdict, said.pending) == (Verdict.UNVERIFIED, False)
    assert said.detail.startswith(
        "Other processor: recorded on toy, toy 1.0, MuJoCo 4.0.0 toy (fingerprint aa)."
    )
    assert (said.first_different_tick, said.within_tolerance, said.numeric_fingerprint) == (2, True, "cc")
    assert said.largest_difference["positions"] == 1e-9


def test_a_spoilt_state_on_another_processor_is_no_divergence_and_out_of_tolerance(tmp_path: Path) -> None:
    states = synthetic.states(30)
    states[9].integration_state = bytes(64)
    said = verdict(tmp_path, states, ask=on("cc", "dd"))
    assert (said.verdict, said.within_tolerance) == (Verdict.UNVERIFIED, False)


@pytest.mark.parametrize("ask", [on("cc", "aa"), on("aa", "cc")], ids=["natively", "as services compute"])
@pytest.mark.parametrize("room", [_ROOM, _BEFORE_FINGERPRINTS], ids=["with", "before"])
def test_what_follows_in_one_of_two_ways_is_verified(
    tmp_path: Path, room: RoomRecord, ask: synthetic.ToyReplica
) -> None:
    said = verdict(tmp_path, synthetic.states(30), room, ask)
    assert (said.verdict, said.detail) == (Verdict.VERIFIED, "30 ticks re-simulated bit for bit.")
    assert said.numeric_fingerprint == "aa"


def test_what_differs_natively_on_its_own_processor_diverged(tmp_path: Path) -> None:
    states = synthetic.states(30)
    states[9].integration_state = bytes(64)
    said = verdict(tmp_path, states, ask=on("cc", "aa"))
    assert (said.verdict, said.first_different_tick) == (Verdict.DIVERGED, 9)


@pytest.mark.parametrize(("differs_by", "expected"), [(1e-9, Verdict.UNVERIFIED), (1.0, Verdict.DIVERGED)])
def test_a_file_from_before_fingerprints_is_judged_by_its_size(
    tmp_path: Path, differs_by: float, expected: Verdict
) -> None:
    said = verdict(tmp_path, synthetic.states(30), _BEFORE_FINGERPRINTS, on("cc", "dd", differs_by))
    assert said.verdict is expected
    assert said.pending is False


def test_an_infinite_difference_is_a_verdict_too(tmp_path: Path) -> None:
    said = verdict(tmp_path, synthetic.states(30), ask=on("cc", "dd", float("inf")))
    assert (said.verdict, said.within_tolerance) == (Verdict.UNVERIFIED, False)
    assert VerificationRecord.from_strings(said.to_strings()) == said


def test_a_gap_is_said(tmp_path: Path) -> None:
    said = verdict(tmp_path, list(synthetic.without(synthetic.states(30), 10, 11)))
    assert said.verdict is Verdict.UNVERIFIED
    assert said.detail == "27 ticks re-simulated bit for bit; not those from 9 to 12."


def test_a_file_that_begins_in_the_middle_is_verified_from_there(tmp_path: Path) -> None:
    assert verdict(tmp_path, synthetic.states(30)[12:]).detail.startswith("18 ticks")


def test_one_state_alone_says_nothing(tmp_path: Path) -> None:
    assert verdict(tmp_path, synthetic.states(0)).verdict is Verdict.UNVERIFIED


@pytest.mark.parametrize("numbers", [[0.0] * 6, [0.0] * 8, [float("nan")] * 7], ids=["short", "long", "nan"])
def test_an_action_that_is_none_is_no_crash(tmp_path: Path, numbers: list[float]) -> None:
    states = synthetic.states(5)
    states[3].arms[0].action[:] = numbers
    assert verdict(tmp_path, states).verdict is Verdict.UNVERIFIED


def test_a_room_that_is_not_known_cannot_be_stepped(tmp_path: Path) -> None:
    said = verdict(tmp_path, synthetic.states(5), RoomRecord(room=synthetic.ROOM))
    assert said.verdict is Verdict.UNVERIFIED
    assert "does not say its task" in said.detail


def test_every_tick_that_differs_is_listed(tmp_path: Path) -> None:
    states = synthetic.states(10)
    states[4].integration_state = b"elsewhere"
    (stretch,) = compare(recorded(tmp_path, states), _ROOM, synthetic.ToyReplica())
    assert (stretch.first_tick, stretch.last_tick, stretch.different) == (0, 10, (4,))


@given(gone=st.sets(st.integers(0, 24)), most=st.integers(1, 30))
def test_stretches_cover_every_tick_that_can_be_checked(gone: set[int], most: int) -> None:
    kept = list(synthetic.without(synthetic.states(25), *gone))
    ticks = [state.tick for state in kept]
    found = list(stretches(iter(kept), most))
    covered = [tick for stretch in found for tick in range(stretch.first_tick + 1, stretch.last_tick + 1)]
    assert covered == [tick for tick in ticks if tick - 1 in ticks]
    assert all(len(stretch.digests) <= most for stretch in found)
    for stretch in found:
        if stretch.digests:
            assert synthetic.resimulate(stretch.request(_ROOM)) == b"".join(stretch.digests)


def test_a_replica_is_asked_over_the_bus(tmp_path: Path) -> None:
    network = MemoryNetwork()
    server = network.connect()
    server.serve(
        rollout("replica-1"), lambda request: request.reply(synthetic.rollout_reply(request.payload))
    )
    server.announce(alive(ServiceKind.REPLICA, "replica-1"))
    said = verify(recorded(tmp_path, synthetic.states(30)), _ROOM, replica(network.connect(), "replica-1"))
    assert said.verdict is Verdict.VERIFIED


def test_a_replica_that_is_away_leaves_the_file_unverified(tmp_path: Path) -> None:
    ask = replica(MemoryNetwork().connect(), "replica-1", patience_s=0.0)
    said = verify(recorded(tmp_path, synthetic.states(30)), _ROOM, ask)
    assert said.verdict is Verdict.UNVERIFIED
    assert "No replica 'replica-1' is up" in said.detail
    assert said.pending


@pytest.mark.parametrize("forgotten", [1, 2])
def test_a_replica_of_which_the_router_knows_nothing_for_a_moment_is_awaited(
    tmp_path: Path, forgotten: int
) -> None:
    class Restarted(DeafBus):
        """A router that was started anew has not heard of the replica when it is asked for the first or second time."""

        asked = 0

        def alive(self, alive_expression: str, timeout_s: float = 1.0) -> list[str]:
            self.asked += 1
            return [] if self.asked == forgotten else super().alive(alive_expression, timeout_s)

    network = MemoryNetwork()
    server = network.connect()
    server.serve(
        rollout("replica-1"), lambda request: request.reply(synthetic.rollout_reply(request.payload))
    )
    server.announce(alive(ServiceKind.REPLICA, "replica-1"))
    ask = replica(Restarted(network), "replica-1")
    for _ in range(2):
        said = verify(recorded(tmp_path, synthetic.states(3)), _ROOM, ask)
        assert said.verdict is Verdict.VERIFIED, said.detail


def test_a_router_that_is_away_when_the_first_file_is_verified_is_awaited(tmp_path: Path) -> None:
    network = MemoryNetwork()
    server = network.connect()
    server.serve(
        rollout("replica-1"), lambda request: request.reply(synthetic.rollout_reply(request.payload))
    )
    server.announce(alive(ServiceKind.REPLICA, "replica-1"))
    said = verify(recorded(tmp_path, synthetic.states(3)), _ROOM, replica(DistantBus(network), "replica-1"))
    assert said.verdict is Verdict.VERIFIED, said.detail


def test_what_a_replica_refuses_is_said(tmp_path: Path) -> None:
    network = MemoryNetwork()
    server = network.connect()
    refusal = codec.encode(RolloutReply(error=Error(code="Conflict", message="Another model is compiled.")))
    server.serve(rollout("replica-1"), lambda request: request.reply(refusal))
    server.announce(alive(ServiceKind.REPLICA, "replica-1"))
    said = verify(recorded(tmp_path, synthetic.states(3)), _ROOM, replica(network.connect(), "replica-1"))
    assert (said.verdict, said.detail) == (Verdict.UNVERIFIED, "Another model is compiled.")
    assert said.pending is False


def test_an_answer_of_the_wrong_length_is_corrupt(tmp_path: Path) -> None:
    def short(_request: RolloutRequest) -> RolloutReply:
        return RolloutReply(state_digests=b"short")

    with pytest.raises(Corrupt):
        list(compare(recorded(tmp_path, synthetic.states(3)), _ROOM, short))
