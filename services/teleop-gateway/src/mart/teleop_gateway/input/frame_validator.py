"""Drop bad frames of a phone, and let go of the clutch where the hand is in doubt.

Pure: payloads and `now_s` in, admitted frames out. The rules are in docs/protocol.md, "Phone frame".
"""

from __future__ import annotations

import enum
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mart.protocol.pose import Pose
from mart.runtime.queueing_delay import QueueingDelay
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.input.phone_frame import Flag, MalformedFrame, PhoneFrame

MAX_FRAMES_PER_S = 120
MAX_DISTANCE_M = 100.0
NORM_TOLERANCE = 0.01
GAP_S = 0.2
JUMP_M = 0.15
JUMP_RAD = 0.6
JUMP_WITHIN_S = 0.1
MAX_WAIT_S = 0.5  # on the way, beyond the quickest frame of the last seconds


class FrameRejection(enum.StrEnum):
    """Name why a frame was dropped."""

    RATE = "rate"
    MALFORMED = "malformed"
    EPOCH = "epoch"
    SEQUENCE = "sequence"
    NOT_FINITE = "not_finite"
    NORM = "norm"
    GRIPPER = "gripper"
    POSITION = "position"
    AGE = "age"


class LetGo(enum.StrEnum):
    """Name why a clutch that is held does not count."""

    NEW = "new"  # held since before this peer came
    TRACKING = "tracking"  # the phone did not know where it was
    GAP = "gap"  # frames were missing
    JUMP = "jump"  # it was somewhere else at once
    AGE = "age"  # the frame was on its way for too long
    PICTURE = "picture"  # what the person drives by stood still
    STOP = "stop"  # an emergency stop was on
    PAUSE = "pause"  # the room waited for somebody, and the world stood still


class _Rejected(Exception):
    def __init__(self, reason: FrameRejection) -> None:
        super().__init__(reason)
        self.reason = reason


@dataclass(frozen=True)
class HandSample:
    """Hold a good frame. `clutch`: held, and nothing speaks against it; `let_go`: what speaks against a held one.

    waited: it comes so late that nothing in it counts but an emergency stop. doubt: what speaks against this frame,
    whether or not the clutch is held.
    """

    frame: PhoneFrame
    pose_phone_in_session: Pose
    clutch: bool
    let_go: LetGo | None = None
    waited: bool = False
    doubt: LetGo | None = None


class FrameValidator:
    """Watch the frames of one peer, and count those that are dropped."""

    def __init__(self, seat_epoch: int) -> None:
        self.rejected: Counter[FrameRejection] = Counter()
        self._seat_epoch = seat_epoch
        self._rate = RateLimit(MAX_FRAMES_PER_S)
        self._delay = QueueingDelay()
        self._last: HandSample | None = None
        self._last_s = -math.inf
        self._let_go: LetGo | None = LetGo.NEW  # until the clutch is open

    @property
    def last_good_s(self) -> float:
        """Return when the last good frame came; minus infinity before the first."""
        return self._last_s

    def validate(self, payload: bytes, now_s: float) -> HandSample | None:
        """Return the hand that this payload shows, or None where it was dropped (and counted)."""
        try:
            return self._accept(self._read(payload, now_s), now_s)
        except _Rejected as error:
            self.rejected[error.reason] += 1
            return None

    def _read(self, payload: bytes, now_s: float) -> PhoneFrame:
        if not self._rate.allows(now_s):
            raise _Rejected(FrameRejection.RATE)
        try:
            frame = PhoneFrame.decode(payload)
        except MalformedFrame as error:
            raise _Rejected(FrameRejection.MALFORMED) from error
        for reason, holds in self._rules(frame):
            if not holds:
                raise _Rejected(reason)
        return frame

    def _rules(self, frame: PhoneFrame) -> Iterator[tuple[FrameRejection, bool]]:
        """Yield what must hold, in order: a later rule may rely on an earlier one."""
        newest = self._last.frame.sequence if self._last else -1
        numbers = (*frame.position, *frame.quaternion_wxyz, frame.gripper)
        yield FrameRejection.EPOCH, frame.seat_epoch == self._seat_epoch
        yield FrameRejection.SEQUENCE, frame.sequence > newest
        yield FrameRejection.NOT_FINITE, all(map(math.isfinite, numbers))
        yield FrameRejection.NORM, abs(math.hypot(*frame.quaternion_wxyz) - 1.0) <= NORM_TOLERANCE
        yield FrameRejection.GRIPPER, 0.0 <= frame.gripper <= 1.0
        yield FrameRejection.POSITION, math.hypot(*frame.position) <= MAX_DISTANCE_M

    def _accept(self, frame: PhoneFrame, now_s: float) -> HandSample:
        pose = Pose(np.array(frame.position), np.array(frame.quaternion_wxyz))
        pressed = Flag.CLUTCH in frame.flags
        waited = self._delay.waited_s(frame.sent_us * 1e-6, now_s) > MAX_WAIT_S
        doubt = LetGo.AGE if waited else self._doubt(frame, pose, now_s)
        if doubt is not None:
            self._let_go = self._let_go or doubt
        elif not pressed:
            self._let_go = None
        if waited and pressed:
            self.rejected[FrameRejection.AGE] += 1
        hand = HandSample(
            frame=frame,
            pose_phone_in_session=pose,
            clutch=pressed and not self._let_go,
            let_go=self._let_go if pressed else None,
            waited=waited,
            doubt=doubt,
        )
        self._last, self._last_s = hand, now_s
        return hand

    def let_go(self, hand: HandSample, reason: LetGo) -> HandSample:
        """Return the hand with an open clutch; it counts as open until it is, and is pressed anew."""
        if not hand.clutch:
            return hand
        self._let_go = reason
        self._last = HandSample(hand.frame, hand.pose_phone_in_session, False, reason)
        return self._last

    def _doubt(self, frame: PhoneFrame, pose: Pose, now_s: float) -> LetGo | None:
        """Return what speaks against this hand; a gap or a jump matters only while the clutch is held."""
        if Flag.TRACKING not in frame.flags:
            return LetGo.TRACKING
        if Flag.CLUTCH not in frame.flags:
            return None
        if now_s - self._last_s > GAP_S:
            return LetGo.GAP
        return LetGo.JUMP if self._jumped(frame, pose) else None

    def _jumped(self, frame: PhoneFrame, pose: Pose) -> bool:
        if self._last is None or (frame.sent_us - self._last.frame.sent_us) * 1e-6 >= JUMP_WITHIN_S:
            return False
        metres, radians = pose.distance_to(self._last.pose_phone_in_session)
        return metres > JUMP_M or radians > JUMP_RAD
