"""Kinds of arms: what each one is, as its robot file says, with what it holds at its end.

A kind has a name: that of a file in this folder, or of one among people's own (`MART_ARMS_DIR`, data/arms unless told);
after a plus sign that of an end effector, where it is not the one that the robot file names. Whoever says nothing of an
arm's kind means a Panda.
"""

from __future__ import annotations

from mart.protocol.arms.end_effector import EndEffector
from mart.protocol.arms.finding import (
    PANDA,
    arm_kind,
    arm_kind_names,
    arms_folder,
    end_effector,
    end_effector_names,
    load_end_effector_file,
    load_robot_file,
)
from mart.protocol.arms.robot_file import ArmKind
from mart.protocol.arms.workspace import Limits, Workspace

__all__ = [
    "PANDA",
    "ArmKind",
    "EndEffector",
    "Limits",
    "Workspace",
    "arm_kind",
    "arm_kind_names",
    "arms_folder",
    "end_effector",
    "end_effector_names",
    "load_end_effector_file",
    "load_robot_file",
]
