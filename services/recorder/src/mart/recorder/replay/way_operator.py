"""Lead arms along a way, tick by tick, as an operator of their seats. Pure."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from mart.operators import Operator, SeatView, ToolTarget
from mart.protocol.errors import Conflict
from mart.recorder.replay.led_way import LedWay, RecordedWay, StandingArm, joint_observation, require_near

LET_GO_TICKS = 3  # before the clutch is pressed: room and driver must each see that it was let go
STALLS_AFTER_S = 3.0
_SETTLES_M, _SETTLES_RAD = 0.02, 0.1  # from the way's end, where it is over


class WayOperator(Operator):
    """Lead arms to where a recording began and along it; `done` is called once, at its end.

    The way waits wherever an arm is more than one of its largest steps behind; where that lasts, the replay is over.
    Nothing of it outlasts a reset of the world or the loss of a seat: it raises Conflict then.
    """

    def __init__(self, way: RecordedWay, speed: float, control_hz: float, done: Callable[[], None]) -> None:
        self.time_s = 0.0  # of the way, so far
        self._recorded, self._speed, self._period_s, self._done = way, speed, 1.0 / control_hz, done
        self._led: LedWay | None = None
        self._begun = False
        self._let_go_ticks = 0
        self._waited_s = 0.0

    def begin(self, episode: int) -> None:
        """Begin once. Raises Conflict where the world was reset or the seat was another's meanwhile."""
        if self._begun:
            raise Conflict("The world was reset or a seat was taken meanwhile, so the replay is over.")
        self._begun = True

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return where to lead the arms in this tick. Raises Conflict where one is too far off or does not follow."""
        if self._let_go_ticks < LET_GO_TICKS:
            self._let_go_ticks += 1
            begin = self._recorded.at(0.0)
            return {
                arm: ToolTarget(pose, begin[arm].gripper, engaged=False)
                for arm, pose in view.poses_tool_in_base.items()
            }
        if self._led is None:
            self._led = self._from(view)
        self._go_on(self._led, view)
        return self._led.at(self.time_s)

    def _from(self, view: SeatView) -> LedWay:
        """Return the way from where the arms stand by now: the first state may be from before they were moved."""
        stands = {
            arm: StandingArm(pose, view.observations[joint_observation(arm)])
            for arm, pose in view.poses_tool_in_base.items()
        }
        require_near(self._recorded, stands)
        return LedWay(self._recorded, dict(view.poses_tool_in_base), self._speed)

    def _go_on(self, led: LedWay, view: SeatView) -> None:
        targets = led.at(self.time_s)
        over = self.time_s >= led.duration_s
        if over and not _behind(targets, view, settles=True):
            self._done()
        behind = _behind(targets, view, settles=over)
        if not behind:
            self._waited_s = 0.0
            self.time_s = min(self.time_s + self._period_s, led.duration_s)
            return
        self._waited_s += self._period_s
        if self._waited_s >= STALLS_AFTER_S:
            raise Conflict(
                f"{behind}, and did not get there within {STALLS_AFTER_S:g} s: the replay is over."
            )


def _behind(targets: Mapping[str, ToolTarget], view: SeatView, *, settles: bool) -> str:
    """Return which arm is further behind than it may be, in words; empty where none is."""
    for arm, target in targets.items():
        limits = view.task.arm(arm).kind.limits
        most_m, most_rad = (_SETTLES_M, _SETTLES_RAD) if settles else (limits.step_m, limits.step_rad)
        away_m, away_rad = view.poses_tool_in_base[arm].distance_to(target.pose_tool_in_base)
        if away_m > most_m or away_rad > most_rad:
            return f"{arm} is {away_m:.2f} m and {away_rad:.2f} rad behind the way"
    return ""
