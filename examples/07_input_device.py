"""Drive a seat with an input device of your own: here the keys of a terminal, which could be a joystick or a glove.

Start the platform with `make run` and this in a second terminal:

    .venv/bin/python examples/07_input_device.py arm0

w s forward and back, a d left and right, r f up and down, space opens and closes the gripper, q leaves.
"""

from __future__ import annotations

import contextlib
import queue
import sys
import termios
import threading
import tty
from collections.abc import Iterator, Mapping

import numpy as np

from mart.operators import Operator, OperatorKind, SeatView, ToolTarget, drive_seats

STEP_M = 0.01
STEPS = {"w": (1, 0, 0), "s": (-1, 0, 0), "a": (0, 1, 0), "d": (0, -1, 0), "r": (0, 0, 1), "f": (0, 0, -1)}


class TerminalKeys(Operator):
    """Reads keys as they come. Half a second after the last one the clutch is let go, and the arm holds where it is."""

    def __init__(self, left: threading.Event) -> None:
        self._keys: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._left, self._gripper = left, 0.0
        threading.Thread(target=self._read, daemon=True).start()

    def begin(self, episode: int) -> None:
        self._goals: Mapping[str, ToolTarget] = {}
        self._pressed_s = -1.0

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        keys = [self._keys.get() for _ in range(self._keys.qsize())]
        if keys.count(" ") % 2:
            self._gripper = 1.0 - self._gripper
        if keys:
            step_m = STEP_M * sum((np.array(STEPS[key]) for key in keys if key in STEPS), np.zeros(3))
            self._goals = {
                arm: view.step(arm, step_m, gripper=self._gripper) for arm in view.poses_tool_in_base
            }
            self._pressed_s = view.sim_time_s
        if self._goals and view.sim_time_s - self._pressed_s < 0.5:
            return self._goals
        return {
            arm: ToolTarget(pose, self._gripper, engaged=False)
            for arm, pose in view.poses_tool_in_base.items()
        }

    def _read(self) -> None:
        while (key := sys.stdin.read(1)) not in ("q", ""):
            self._keys.put(key)
        self._left.set()


@contextlib.contextmanager
def every_key_at_once() -> Iterator[None]:
    """A terminal gives whole lines unless it is told otherwise; what is no terminal is read as it is."""
    if not sys.stdin.isatty():
        yield
        return
    before = termios.tcgetattr(sys.stdin)
    tty.setcbreak(sys.stdin)
    try:
        yield
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


if __name__ == "__main__":
    left = threading.Event()
    with every_key_at_once():
        drive_seats(
            TerminalKeys(left), arms=sys.argv[1:] or ["arm0"], name="keys", kind=OperatorKind.HUMAN, stop=left
        )
