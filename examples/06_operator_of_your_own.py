"""Drive a seat with a program of your own, beside scripts and people.

Start the platform with `make run` and this in a second terminal:

    .venv/bin/python examples/06_operator_of_your_own.py

Open the lobby to watch, or to take over the arm in the middle of it.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping

import numpy as np

from mart.operators import Operator, SeatView, ToolTarget, drive_seats

ARM, CUBE = "arm0", "cube0"


class CubeLifter(Operator):
    """Goes above the cube, down to it, closes the gripper and lifts. Drops and misses are tried again."""

    def begin(self, episode: int) -> None:
        self.gripping_ticks = 0

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        base = view.task.arm(ARM).pose_base_in_world
        cube_m = base.inverse().transform_points(view.observations[f"{CUBE}/position_in_world"])
        away_m = cube_m - view.poses_tool_in_base[ARM].position
        beside = np.linalg.norm(away_m[:2]) > 0.01
        if np.linalg.norm(away_m) > (0.05 if self.gripping_ticks else 0.015):
            self.gripping_ticks = 0
            away_m[2] += 0.12 if beside else 0.0
            return {ARM: view.step(ARM, np.clip(away_m, -0.03, 0.03), gripper=0.0)}
        self.gripping_ticks += 1
        rise_m = 0.02 if self.gripping_ticks > 8 and view.poses_tool_in_base[ARM].position[2] < 0.3 else 0.0
        return {ARM: view.step(ARM, (0.0, 0.0, rise_m), gripper=1.0)}


if __name__ == "__main__":
    room = sys.argv[1] if len(sys.argv) > 1 else "room-1"
    (outcome,) = drive_seats(
        CubeLifter(), room, [ARM], name="cube lifter", control_hz=20.0, episodes=1, fill_with_scripts=True
    )
    print(f"The episode ended with {outcome}.")
