"""Plan the handover: arm 0 opens the container and holds the hammer out; arm 1 clears the bin and lays it there.

The two agree by what they see: arm 1 comes when the hammer hangs still in the air, arm 0 lets go when the other tool
has rested at the far end of the handle for a while, arm 1 leaves when the other tool has gone.
"""

from __future__ import annotations

import math
from itertools import cycle

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm, Workspace
from mart.protocol.tasks.two_arm_pick_place_handover import OFFER_M
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import (
    StillnessDetector,
    across,
    apart_m,
    at,
    level,
    seen,
    seen_tool,
    standing,
    upright,
)
from mart.sim.experts.pick_and_place import PickAndPlace
from mart.sim.experts.plan import (
    CLOSED,
    OPEN,
    ExpertPlan,
    OperatorObservation,
    PlanStep,
    Waypoint,
    go,
    stay,
    wait,
)

_LID_KNOB = at(0.0, 0.0, 0.024)
# Where a hammer's handle is gripped, along it; and where else, if it is held so that nothing better can be reached.
_HEAD_END_M, _FREE_END_M, _MIDDLE_M = -0.055, 0.075, 0.03
_HEAD_END, _FREE_END = at(_HEAD_END_M, 0.0, 0.0), at(_FREE_END_M, 0.0, 0.0)
_TAIL_M, _NECK_M = (_FREE_END_M, 0.0875, 0.10), (_HEAD_END_M, -0.07, -0.085)
_HAND_M = 0.10  # how far two hands on it must be apart: wrists are broader than fingers
_LENGTH_M = (-0.14, 0.11)

# In the world.
_LID_PLACE = at(-0.27, -0.16, 0.075)
_OFFER = at(*OFFER_M)  # of the hammer
_BACK = at(-0.03, 0.0, 0.07)  # of a hammer that arm 1 lays down for arm 0
_AWAIT, _RETREAT = at(0.25, 0.0, 0.34), at(-0.25, 0.0, 0.34)  # of arm 1's tool and of arm 0's
_FETCHED_TO_M = 0.03  # beyond the offer: where a hammer lies further, it is arm 1 who can reach it
_IN_THE_AIR_Z_M, _SAG_M = 0.17, 0.01  # from 0.16 on it counts; it may sag that much while the partner comes

_OPEN_M = 0.20  # of the lid from the container
_TRAY_HALF_M, _BIN_HALF_M = (0.06, 0.06), (0.15, 0.08)  # inside, with something to spare
_LOW_M = 0.045  # over a floor: what is that low lies there
_ON_FLOOR = at(0.0, 0.0, 0.02)
_CLEAR_M = 0.09
_BESIDE_M = (
    0.0,
    0.022,
    -0.022,
)  # one attempt after the other at a hammer that lies: a wall may be in the way
_QUARTER_TURN = upright(np.zeros(3), math.pi / 2)
_STILL_M, _STILL_S = 0.02, 0.3
_PARTNER_M, _PARTNER_S = 0.04, 0.6
_ATTEMPT_S = 8.0
_PULL, _PULL_AFTER_S = at(0.0, 0.0, -0.015), 3.0
_REACH_M, _ABOVE = 0.01, at(0.0, 0.0, 0.04)  # how far beyond the workspace it may be; from where it comes
_PARTNER_OFF_M, _PARTNER_GONE_M = 0.045, 0.09  # of a tool that has let go, and of one that is out of the way


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Yield the waypoints of one arm: the fetcher's (arm 0), or the receiver's (arm 1)."""
    if arm.name == "arm0":
        fetcher = _Fetcher(arm, human)
        while True:
            while not fetcher.is_open(obs):
                obs = yield from fetcher.remove_lid(obs)
            while fetcher.has_to_fetch(obs):
                obs = yield from fetcher.offer_hammer(obs)
            obs = yield fetcher.retreat
    receiver = _Receiver(arm, human)
    while True:
        while not receiver.is_clear(obs):
            obs = yield from receiver.clear_trash(obs)
        while not receiver.has_placed(obs):
            obs = yield from receiver.take_hammer(obs)
        obs = yield receiver.retreat


class _Fetcher:
    """Act as arm 0: open the container, hold the hammer out."""

    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        self._human = human
        to_base = arm.pose_base_in_world.inverse()
        self._lid, self._container = seen(arm, "lid"), seen(arm, "container")
        self._hammer, self._partner = seen(arm, "hammer"), seen_tool(arm, "arm1")
        self._knob = PickAndPlace(human, self._lid, lambda now: across(self._lid(now) @ _LID_KNOB))
        self._handle = PickAndPlace(human, self._hammer, lambda now: across(_own_end(self._hammer(now))))
        self._sides = cycle(_BESIDE_M)
        self._lid_place, self._offer = to_base @ _LID_PLACE, to_base @ _OFFER
        self.retreat = Waypoint(across(to_base @ _RETREAT), OPEN)

    def is_open(self, now: OperatorObservation) -> bool:
        """Whether the lid is away, and down."""
        x, y, z = self._lid(now).position - self._container(now).position
        return math.hypot(x, y) > _OPEN_M and z < _LOW_M

    def remove_lid(self, obs: OperatorObservation) -> PlanStep:
        """Try once to lay the lid aside."""
        obs = yield from self._knob.pick(obs)
        return (yield from self._knob.put(obs, self._place_of_lid, _CLEAR_M, self.is_open))

    def has_to_fetch(self, now: OperatorObservation) -> bool:
        """Whether the hammer lies where this arm can reach it."""
        x, _, z = self._hammer(now).position
        return z < _IN_THE_AIR_Z_M and x < self._offer.position[0] + _FETCHED_TO_M

    def offer_hammer(self, obs: OperatorObservation) -> PlanStep:
        """Try once: out of the container, held out until the partner has it, let go."""
        obs = yield from self._handle.pick(obs, beside_m=next(self._sides))
        obs = yield from self._handle.raise_to(obs, self._offer.position[2])
        still = StillnessDetector(self._partner, _STILL_M, _PARTNER_S)
        obs = yield from self._handle.bring(
            obs, self._place_of_offer, lambda now: still(now) and self._is_gripped_by_partner(now)
        )
        obs = yield from self._handle.let_go(obs)
        if self.has_to_fetch(obs):
            return obs
        return (yield from go(obs, lambda _: self.retreat, patience_s=2.0))

    def _place_of_lid(self, now: OperatorObservation) -> Pose:
        return standing(self._lid_place, self._lid(now), math.pi)

    def _place_of_offer(self, now: OperatorObservation) -> Pose:
        return level(self._offer, self._hammer(now))

    def _is_gripped_by_partner(self, now: OperatorObservation) -> bool:
        return apart_m(_other_end(self._hammer(now)), self._partner(now)) < _PARTNER_M


class _Receiver:
    """Act as arm 1: clear the bin, take the hammer over, lay it there."""

    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        self._human = human
        to_base = arm.pose_base_in_world.inverse()
        self._trash, self._tray, self._bin = (seen(arm, name) for name in ("trash", "trash_tray", "bin"))
        self._hammer, self._partner = seen(arm, "hammer"), seen_tool(arm, "arm0")
        along = PickAndPlace(human, self._trash, lambda now: across(self._trash(now), math.pi / 2))
        athwart = PickAndPlace(
            human, self._trash, lambda now: across(self._trash(now), math.pi / 2) @ _QUARTER_TURN
        )
        self._grips = cycle((along, athwart))
        self._workspace = arm.kind.workspace
        self._handle, self._grip_m = PickAndPlace(human, self._hammer, self._grip), _FREE_END_M
        self._sides = cycle(_BESIDE_M)
        self._back, self._taken = to_base @ _BACK, False
        self._reach_x_m = float((to_base @ _OFFER).position[0]) - _FETCHED_TO_M
        self.retreat = Waypoint(across(to_base @ _AWAIT), OPEN)

    def is_clear(self, now: OperatorObservation) -> bool:
        return _lies_in(self._trash(now), self._tray(now), _TRAY_HALF_M)

    def clear_trash(self, obs: OperatorObservation) -> PlanStep:
        """Try once to move the trash, each time across the other two sides of the cube: a wall may be in the way."""
        grip = next(self._grips)
        obs = yield from grip.pick(obs)
        return (yield from grip.put(obs, self._place_of_trash, _CLEAR_M, self.is_clear))

    def has_placed(self, now: OperatorObservation) -> bool:
        """Whether the hammer lies in the bin, and not because it fell there before it was handed over."""
        return self._taken and self._is_in_bin(now)

    def take_hammer(self, obs: OperatorObservation) -> PlanStep:
        """Try once: out of the partner's hand into the bin.

        From where it fell on this arm's shelf as well; only, a hammer that has not been handed over goes back first.
        """
        still = StillnessDetector(self._hammer, _STILL_M, _STILL_S)
        obs = yield from wait(obs, self.retreat, self._human, lambda now: still(now) and self._can_reach(now))
        offered = self._is_in_the_air(obs)
        self._grip_m = self._grip_along_m(obs, offered) or self._grip_m
        give_up_s = obs.sim_time_s + _ATTEMPT_S

        def is_pointless(now: OperatorObservation) -> bool:
            moved_away = offered and not (
                self._is_in_the_air(now, _SAG_M) and _is_reachable(self._grip(now), self._workspace)
            )
            return moved_away or now.sim_time_s > give_up_s

        beside_m = 0.0 if offered else next(self._sides)
        obs = yield from self._handle.pick(obs, is_pointless, beside_m, moves=offered)
        obs = yield from self._await_release(obs, offered)
        if self._taken:
            return (yield from self._handle.put(obs, self._place_of_hammer, _CLEAR_M, self._is_in_bin))
        return (yield from self._handle.put(obs, self._place_back, _CLEAR_M, self._is_back))

    def _await_release(self, obs: OperatorObservation, offered: bool) -> PlanStep:
        """Hold it until the partner's hand is gone; after a while pull, gently: a partner who let go may not leave."""
        here, pull_s = Waypoint(obs.pose_tool_in_base, CLOSED), obs.sim_time_s + _PULL_AFTER_S

        def is_alone(now: OperatorObservation) -> bool:
            lost, off_m = self._handle.is_lost(now), self._partner_off_m(now)
            self._taken |= offered and not lost and off_m > _PARTNER_OFF_M
            return lost or off_m > _PARTNER_GONE_M

        while not is_alone(obs):
            pulled = Waypoint(_PULL @ obs.pose_tool_in_base, CLOSED)
            obs = yield pulled if obs.sim_time_s > pull_s else here
        return (yield from stay(obs, Waypoint(obs.pose_tool_in_base, CLOSED), self._human.notices_s()))

    def _can_reach(self, now: OperatorObservation) -> bool:
        """Whether the hammer is held out where this arm gets to, or lies on the own shelf."""
        if self._is_in_the_air(now):
            return self._grip_along_m(now, offered=True) is not None
        return bool(self._hammer(now).position[0] < self._reach_x_m)

    def _is_in_the_air(self, now: OperatorObservation, sag_m: float = 0.0) -> bool:
        return bool(self._hammer(now).position[2] > _IN_THE_AIR_Z_M - sag_m)

    def _is_in_bin(self, now: OperatorObservation) -> bool:
        return _lies_in(self._hammer(now), self._bin(now), _BIN_HALF_M)

    def _grip(self, now: OperatorObservation) -> Pose:
        """Return the tool that grips the handle where this attempt does."""
        return across(self._hammer(now) @ at(self._grip_m, 0.0, 0.0))

    def _grip_along_m(self, now: OperatorObservation, offered: bool) -> float | None:
        """Return where along the handle to grip it, as far from the partner's hand as a hand is wide; None: nowhere."""
        hammer = self._hammer(now)
        if not offered:
            return _HEAD_END_M if _points_away(hammer) else _FREE_END_M
        held_m = float((hammer.inverse() @ self._partner(now)).position[0])
        towards_tail = held_m < _MIDDLE_M
        places = _TAIL_M if towards_tail else _NECK_M
        free = (
            place for place in places if abs(place - held_m) > _HAND_M and (place > held_m) == towards_tail
        )
        return next(
            (m for m in free if _is_reachable(across(hammer @ at(m, 0.0, 0.0)), self._workspace)), None
        )

    def _is_back(self, now: OperatorObservation) -> bool:
        x, _, z = self._hammer(now).position
        return bool(x > self._reach_x_m and z < self._back.position[2] + 0.01)

    def _partner_off_m(self, now: OperatorObservation) -> float:
        """Return how far the partner's tool is from the nearest point of the handle."""
        x, y, z = (self._hammer(now).inverse() @ self._partner(now)).position
        return math.hypot(x - min(max(x, _LENGTH_M[0]), _LENGTH_M[1]), y, z)

    def _place_of_trash(self, now: OperatorObservation) -> Pose:
        return standing(self._tray(now) @ _ON_FLOOR, self._trash(now), math.pi / 2)

    def _place_back(self, now: OperatorObservation) -> Pose:
        return level(self._back, self._hammer(now))

    def _place_of_hammer(self, now: OperatorObservation) -> Pose:
        return level(self._bin(now) @ _ON_FLOOR, self._hammer(now))


def _own_end(hammer: Pose) -> Pose:
    """Return the end nearer to the own base: mostly the head's for arm 0, but it may have fallen the other way."""
    return hammer @ (_HEAD_END if _points_away(hammer) else _FREE_END)


def _other_end(hammer: Pose) -> Pose:
    return hammer @ (_FREE_END if _points_away(hammer) else _HEAD_END)


def _points_away(hammer: Pose) -> bool:
    """Whether the hammer's head is nearer to the own base than its handle."""
    return bool(hammer.rotation_matrix()[0, 0] > 0.0)


def _is_reachable(tool: Pose, workspace: Workspace) -> bool:
    """Whether the tool gets there, and to somewhere above it."""
    return all(apart_m(pose, workspace.clamp(pose)) < _REACH_M for pose in (tool, _ABOVE @ tool))


def _lies_in(thing: Pose, box: Pose, half_m: tuple[float, float]) -> bool:
    x, y, z = (box.inverse() @ thing).position
    return abs(x) < half_m[0] and abs(y) < half_m[1] and z < _LOW_M
