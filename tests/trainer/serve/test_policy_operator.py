"""What a policy gives is what is applied, seat by seat, through takeover, hand-back and reset."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.operators import target_from_action
from mart.operators.commander import SeatCommander
from mart.protocol import codec
from mart.protocol.errors import Corrupt
from mart.protocol.messages import (
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    EpisodeRequest,
    Operator,
    SeatRequest,
    State,
)
from mart.sim.world import World
from mart.trainer.models.policies.policy import Policy
from mart.trainer.serve.policy_operator import PolicyOperator, parts_of
from tests.sim.room.room_harness import ARMS, PERIOD_S, RoomHarness
from tests.trainer.serve.toys import TASK, Wanderer, one_action


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


@pytest.fixture
def stage(world: World) -> RoomHarness:
    return RoomHarness(world)


def commander_of(stage: RoomHarness, policy: Policy) -> SeatCommander:
    return SeatCommander(PolicyOperator(policy), stage.world.task, policy.arms, OPERATOR_POLICY, policy.needs)


class Seated:
    """A policy at the arms that are its own in a stage."""

    def __init__(self, stage: RoomHarness, policy: Wanderer) -> None:
        self.stage, self.policy = stage, policy
        self.operators = [commander_of(stage, part) for part in parts_of(policy)]

    def assign(self, arm: str, operator: Operator = OPERATOR_POLICY, policy: str = "wanderer") -> None:
        request = SeatRequest(assign=SeatRequest.Assign(arm=arm, operator=operator, policy=policy))
        assert not self.stage.room.answer_seat(request, self.stage.now_s).error.code

    def drive(self, ticks: int, by_hand: tuple[str, ...] = ()) -> Iterator[State]:
        """The states of these ticks; arms `by_hand` are held still by people."""
        stage = self.stage
        for _ in range(ticks):
            self.speak()
            for arm in by_hand:
                stage.command(arm)
            before = stage.newest.tick
            stage.pass_time(PERIOD_S)
            assert stage.newest.tick == before + 1
            yield stage.newest

    def start_episode(self) -> None:
        ready = EpisodeRequest.Ready(arm="arm0", ready=True)
        assert self.stage.ask(EpisodeRequest(ready=ready)) == ""
        self.stage.pass_time(0.2)
        for _ in range(35):
            self.speak()
            self.stage.pass_time(0.1)
        assert self.stage.status().episode.phase == EPISODE_PHASE_RECORDING

    def speak(self) -> None:
        epochs = {s.arm: s.epoch for s in self.stage.status().seats if s.operator == OPERATOR_POLICY}
        for operator in self.operators:
            operator.seat(epochs)
            operator.observe(self.stage.newest)
            for command in operator.commands(0):
                self.stage.room.hear(codec.encode(command), command.arm, self.stage.now_s, 0)


def applied(state: State, arm: str) -> list[float]:
    return next(list(one.action) for one in state.arms if one.arm == arm)


@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None)
def test_an_action_comes_out_of_the_sim_as_it_went_in(world: World, seed: int) -> None:
    world.reset(seed)
    action = one_action(np.random.default_rng(seed))
    target, gripper = target_from_action(
        world.tool_pose_in_base("arm1"), action, world.task.arm("arm1").kind.limits
    )
    np.testing.assert_allclose(world.action_for("arm1", target, gripper), action, atol=1e-9)


@pytest.mark.parametrize("joint", [False, True])
def test_the_recorded_action_is_the_policys_output(stage: RoomHarness, joint: bool) -> None:
    seated = Seated(stage, Wanderer(joint=joint))
    for arm in ARMS:
        seated.assign(arm)
    policies = [seated.policy] if joint else [seated.policy.parts[arm] for arm in ARMS]
    for state in seated.drive(20):
        meant = np.concatenate([policy.given[-1] for policy in policies])
        np.testing.assert_allclose([applied(state, arm) for arm in ARMS], meant, atol=1e-9)
        assert all(arm.source == OPERATOR_POLICY and arm.fresh and arm.engaged for arm in state.arms)


@pytest.mark.parametrize("joint", [False, True])
def test_a_person_takes_one_arm_over_in_mid_episode_and_hands_it_back(
    stage: RoomHarness, joint: bool
) -> None:
    seated = Seated(stage, Wanderer(joint=joint))
    for arm in ARMS:
        seated.assign(arm)
    seated.start_episode()
    sources: list[tuple[int, ...]] = []

    def go_on(ticks: int, by_hand: tuple[str, ...] = ()) -> None:
        for state in seated.drive(ticks, by_hand):
            assert state.episode == 1
            sources.append(tuple(arm.source for arm in state.arms))

    go_on(5)
    before = stage.newest
    stage.take("arm1", "ana")
    assert stage.newest.tick == before.tick  # the world waits for the person
    go_on(5, by_hand=("arm1",))
    hand_back = SeatRequest(hand_back=SeatRequest.HandBack(arm="arm1", holder_id="ana"))
    assert not stage.room.answer_seat(hand_back, stage.now_s).error.code
    go_on(5)
    policies = (OPERATOR_POLICY, OPERATOR_POLICY)
    assert sources == [policies] * 5 + [(OPERATOR_POLICY, OPERATOR_HUMAN)] * 5 + [policies] * 5
    epochs = [arm.seat_epoch for arm in before.arms]
    assert [arm.seat_epoch for arm in stage.newest.arms] == [epochs[0], epochs[1] + 2]


def test_what_is_handed_back_begins_anew_and_what_goes_on_does_not(stage: RoomHarness) -> None:
    per_arm, joint = Seated(stage, Wanderer()), Seated(stage, Wanderer(joint=True))
    state = State.FromString(stage.newest.SerializeToString())
    for arm in state.arms:
        arm.action.extend([0.0] * 7)
    for epochs in ({"arm0": 2, "arm1": 2}, {"arm0": 2}, {"arm0": 2, "arm1": 4}):
        state.tick += 1
        for operator in (*per_arm.operators, *joint.operators):
            operator.seat(epochs)
            operator.observe(state)
    assert [len(per_arm.policy.parts[arm].seeds) for arm in ARMS] == [1, 2]
    assert len(joint.policy.seeds) == 1


def test_a_reset_begins_the_policy_anew_with_the_episodes_number(stage: RoomHarness) -> None:
    seated = Seated(stage, Wanderer(joint=True))
    for arm in ARMS:
        seated.assign(arm)
    list(seated.drive(3))
    seated.start_episode()
    list(seated.drive(3))
    assert seated.policy.seeds[0] == 0
    assert seated.policy.seeds[-1] == 1


def test_the_same_state_again_is_no_news_and_repeats_have_new_numbers(stage: RoomHarness) -> None:
    operator = commander_of(stage, Wanderer(("arm0",)))
    operator.seat({"arm0": 3})
    assert operator.commands(0) == []
    assert operator.observe(stage.newest)
    assert not operator.observe(stage.newest)
    (first,), (second,) = operator.commands(7), operator.commands(8)
    assert (first.arm, first.seat_epoch, first.source, first.stamps.sent_ns) == (
        "arm0",
        3,
        OPERATOR_POLICY,
        7,
    )
    assert second.sequence == first.sequence + 1
    assert second.target_tool_in_base == first.target_tool_in_base


def test_without_a_seat_it_neither_acts_nor_speaks(stage: RoomHarness) -> None:
    policy = Wanderer(("arm0",))
    operator = commander_of(stage, policy)
    operator.seat({"arm1": 3})
    assert not operator.observe(stage.newest)
    assert operator.commands(0) == []
    assert policy.given == []


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_an_action_that_is_no_number_is_never_sent(stage: RoomHarness, bad: float) -> None:
    policy = Wanderer(("arm0",))
    policy.spoilt = bad
    operator = commander_of(stage, policy)
    operator.seat({"arm0": 1})
    with pytest.raises(Corrupt):
        operator.observe(stage.newest)


@pytest.mark.parametrize("spoil", ["observation", "short", "arm"])
def test_a_state_that_does_not_show_enough_is_refused(stage: RoomHarness, spoil: str) -> None:
    operator = commander_of(stage, Wanderer(("arm0",)))
    operator.seat({"arm0": 1})
    state = State.FromString(stage.newest.SerializeToString())
    if spoil == "observation":
        del state.observations[:]
    elif spoil == "short":
        for observation in state.observations:
            del observation.value[0]
    else:
        del state.arms[:]
    with pytest.raises(Corrupt):
        operator.observe(state)
