"""Decide which device drives, and what the arm is asked to do. Pure: payloads and `now` in, commands out."""

from __future__ import annotations

import enum
from collections import Counter
from dataclasses import dataclass, field, replace

from mart.protocol.messages import (
    HAND_FAULT_JUMP,
    HAND_FAULT_TRACKING,
    HAND_FAULT_UNSPECIFIED,
    OPERATOR_HUMAN,
    ArmState,
    Command,
    CommandStamps,
    HandFault,
    pose_message,
)
from mart.teleop_gateway.input.frame_validator import FrameRejection, FrameValidator, HandSample, LetGo
from mart.teleop_gateway.input.grasp import GripperSample, holds
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.picture_watch import PictureWatch
from mart.teleop_gateway.input.retarget import ArmTarget, Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion

LOST_AFTER_S = 0.25
_REMEMBERED_COMMANDS = 512
_FAULTS = {LetGo.TRACKING: HAND_FAULT_TRACKING, LetGo.JUMP: HAND_FAULT_JUMP}
MAX_FRAME_AGE_NS = 1_000_000_000  # an older hand leads nothing
_OLDEST_INPUT_NS = 10_000_000_000  # an older stamp is a wrong clock, not a slow network


class InputDevice(enum.StrEnum):
    """Name what a person drives with."""

    KEYBOARD = "keyboard"  # and mouse, from the browser
    PHONE = "phone"


@dataclass
class _Source:
    """Hold what is known of one driving peer. clock_offset_ns: gateway clock minus the peer's, once it has told."""

    validator: FrameValidator
    grips: bool = False  # its gripper counts
    started: bool = False  # it has known where it is
    last: HandSample | None = None
    clock_offset_ns: int | None = None


@dataclass(frozen=True)
class PhoneState:
    """Tell how long ago the phone's last good frame came, whether it knew where it was, and whether it ever did."""

    age_s: float
    tracking: bool
    started: bool


@dataclass
class Driving:
    """Drive one arm for one holder of its seat (one epoch).

    `first_sequence` must be above every command's number of an earlier process for the same epoch: the sim takes only
    newer ones. `picture` is what the holder sees: while it stands still, no hand counts. gripper_told: what the gripper
    was asked for in the newest tick, by whoever drove then; None: unknown. holding: the gripper has taken hold of
    something. held_by_room: why the room lets no hand count now: an emergency stop, or a pause. gripper_set: how often
    the gripper was set by other than the device in use: by a reset of the world, or by the device before.
    """

    arm: str
    seat_epoch: int
    first_sequence: int
    retarget: Retarget
    picture: PictureWatch = field(default_factory=PictureWatch)
    active: InputDevice = InputDevice.KEYBOARD
    gripper_told: float | None = None
    holding: bool = False
    held_by_room: LetGo | None = None
    gripper_set: int = 0
    _tick: int = 0
    _grip: GripperSample | None = None
    _sources: dict[InputDevice, _Source] = field(default_factory=dict)
    _rejected: Counter[str] = field(default_factory=Counter)
    _target: ArmTarget | None = None
    _sent: int = 0
    _frame_numbers: dict[int, int] = field(default_factory=dict)

    def connect(self, source: InputDevice) -> None:
        """Take a new peer: its numbers begin anew. A phone that comes is meant to be used."""
        self._keep_counts(source)
        self._sources[source] = _Source(FrameValidator(self.seat_epoch))
        if source is InputDevice.PHONE:
            self.select(InputDevice.PHONE)
        else:
            self.picture.page_came()

    def disconnect(self, source: InputDevice) -> None:
        """Forget a peer that left for good; a phone that leaves gives the arm back to the keyboard."""
        self._keep_counts(source)
        self._sources.pop(source, None)
        if source is InputDevice.PHONE:
            self.select(InputDevice.KEYBOARD)

    def select(self, source: InputDevice) -> None:
        """Let this device drive from now on."""
        if source is not self.active:
            self.active = source
            self.retarget.release()
            self._set_gripper()

    def set_clock(self, source: InputDevice, offset_ns: int) -> None:
        """Take the gateway's clock minus the device's, nanoseconds."""
        if source in self._sources:
            self._sources[source].clock_offset_ns = offset_ns

    def clock_offset_ns(self, source: InputDevice) -> int | None:
        """Return the gateway's clock minus the device's; None where the device has not told."""
        known = self._sources.get(source)
        return known.clock_offset_ns if known else None

    def receive(
        self,
        source: InputDevice,
        payload: bytes,
        tool: ToolMotion | None,
        now_s: float,
        now_ns: int,
    ) -> Command | None:
        """Return the command that a frame asks for; None for a bad frame, an input not in use or an unseen arm.

        tool: the newest that is known of the arm's tool. now_s: monotonic; now_ns: wall clock, for the stamps.
        """
        peer = self._sources.get(source)
        hand = peer.validator.validate(payload, now_s) if peer else None
        if peer is None or hand is None:
            return None
        peer.started = peer.started or Flag.TRACKING in hand.frame.flags
        peer.grips = peer.grips or (not hand.waited and _means_its_gripper(hand, peer.last))
        peer.last = hand
        if source is not self.active or tool is None:
            return None
        sent_ns = _input_sent_ns(hand.frame.sent_us, peer.clock_offset_ns, now_ns)
        hand = peer.last = self._unless_blind(peer.validator, hand, sent_ns, now_s, now_ns)
        target = self.retarget.follow(hand, tool)
        follows = peer.grips and not hand.waited
        gripper = target.gripper if follows or self.gripper_told is None else self.gripper
        self._target = replace(target, gripper=gripper)
        command = self._command(hand, self._target, sent_ns, now_ns)
        command.hand_fault = _hand_fault(hand, peer.started)
        return command

    def see(self, arm: ArmState, tick: int, sim_time_s: float, now_s: float) -> None:
        """Take how the arm is after the newest tick, whoever drove it."""
        self._tick = tick
        self.picture.on_state(tick, now_s)
        self.gripper_told = (arm.action[-1] + 1.0) / 2.0 if arm.action else arm.gripper
        grip = GripperSample(arm.gripper, self.gripper_told, sim_time_s)
        self.holding = bool(arm.action) and holds(self.holding, self._grip, grip)
        self._grip = grip

    def _unless_blind(
        self, validator: FrameValidator, hand: HandSample, sent_ns: int, now_s: float, now_ns: int
    ) -> HandSample:
        """Return the hand, let go where it is too old, its person sees nothing move, or the room stands still."""
        if hand.clutch and sent_ns and now_ns - sent_ns > MAX_FRAME_AGE_NS:
            validator.rejected[FrameRejection.AGE] += 1
            return validator.let_go(hand, LetGo.AGE)
        if self.held_by_room is not None:
            return validator.let_go(hand, self.held_by_room)
        if hand.clutch and self.picture.stands_still(now_s):
            return validator.let_go(hand, LetGo.PICTURE)
        return hand

    def world_was_reset(self) -> None:
        """Let go of everything: targets from before the reset mean nothing now. The gripper begins open."""
        self._target = None
        self.retarget.forget()
        self.gripper_told = 0.0
        self._set_gripper()

    def lost(self, now_s: float) -> bool:
        """Tell whether the input in use has been silent for too long."""
        peer = self._sources.get(self.active)
        return peer is None or now_s - peer.validator.last_good_s > LOST_AFTER_S

    def let_go(self, now_s: float) -> LetGo | None:
        """Return why the clutch that is held does not lead the arm; None where it does, or is not held."""
        peer = self._sources.get(self.active)
        return peer.last.let_go if peer and peer.last and not self.lost(now_s) else None

    def engaged(self, now_s: float) -> bool:
        """Tell whether the arm follows a hand now."""
        return self._target is not None and self._target.engaged and not self.lost(now_s)

    @property
    def gripper(self) -> float:
        """Return what the gripper was asked for last, 0 open … 1 closed."""
        return self._target.gripper if self._target else self.gripper_told or 0.0

    def phone(self, now_s: float) -> PhoneState | None:
        """Return how the phone is; None where none has sent a good frame."""
        peer = self._sources.get(InputDevice.PHONE)
        if peer is None or peer.last is None:
            return None
        tracking = Flag.TRACKING in peer.last.frame.flags
        return PhoneState(now_s - peer.validator.last_good_s, tracking, peer.started)

    def rejected(self) -> Counter[str]:
        """Return how many frames were dropped since this holder came, by reason."""
        return sum((_counts(peer.validator) for peer in self._sources.values()), Counter(self._rejected))

    def frame_number(self, sequence: int) -> int | None:
        """Return the number of the frame that became this command; None where it was not this process's."""
        return self._frame_numbers.get(sequence)

    def _set_gripper(self) -> None:
        """Tell that the gripper is not where a device left it: devices follow, and count once they say otherwise."""
        self.gripper_set += 1
        for peer in self._sources.values():
            peer.grips = False

    def _keep_counts(self, source: InputDevice) -> None:
        if source in self._sources:
            self._rejected += _counts(self._sources[source].validator)

    def _command(self, hand: HandSample, target: ArmTarget, input_sent_ns: int, now_ns: int) -> Command:
        sequence = self.first_sequence + self._sent
        self._sent += 1
        self._frame_numbers[sequence] = hand.frame.sequence
        self._frame_numbers.pop(sequence - _REMEMBERED_COMMANDS, None)
        return Command(
            arm=self.arm,
            seat_epoch=self.seat_epoch,
            sequence=sequence,
            target_tool_in_base=pose_message(target.pose_tool_in_base),
            gripper=target.gripper,
            engaged=target.engaged,
            source=OPERATOR_HUMAN,
            stamps=CommandStamps(
                input_sent_ns=input_sent_ns,
                gateway_received_ns=now_ns,
            ),
            seen_tick=hand.frame.seen_tick,
            state_tick=self._tick,
            emergency_stop=Flag.EMERGENCY_STOP in hand.frame.flags,
        )


def _hand_fault(hand: HandSample, started: bool) -> HandFault:
    """Return what the device lost of the hand; a phone that has not been started yet has nothing to lose."""
    return (
        _FAULTS.get(hand.doubt, HAND_FAULT_UNSPECIFIED) if started and hand.doubt else HAND_FAULT_UNSPECIFIED
    )


def _means_its_gripper(hand: HandSample, before: HandSample | None) -> bool:
    """Tell whether a hand's gripper counts: who does not know what it holds must drop nothing.

    It is meant where it changes, and where the clutch is pressed.
    """
    if before is None:
        return hand.clutch
    return (hand.clutch and not before.clutch) or hand.frame.gripper != before.frame.gripper


def _counts(validator: FrameValidator) -> Counter[str]:
    return Counter({reason.value: number for reason, number in validator.rejected.items()})


def _input_sent_ns(sent_us: int, clock_offset_ns: int | None, now_ns: int) -> int:
    """Return the peer's sending time on the gateway's clock; 0 where it is unknown or cannot be true."""
    if clock_offset_ns is None:
        return 0
    sent_ns = sent_us * 1000 + clock_offset_ns
    return sent_ns if max(now_ns - _OLDEST_INPUT_NS, 0) < sent_ns <= now_ns + _OLDEST_INPUT_NS else 0
