"""Kinds of arms: what each one is, as its robot file says.

A kind has a name: that of a file in this folder, or of one among people's own (`MART_ARMS_DIR`, data/arms unless told).
Whoever says nothing of an arm's kind means a Panda.
"""

from __future__ import annotations

from mart.protocol.arms.finding import PANDA, arm_kind, arm_kind_names, arms_folder, load_robot_file
from mart.protocol.arms.robot_file import ArmKind
from mart.protocol.arms.workspace import Limits, Workspace

__all__ = [
    "PANDA",
    "ArmKind",
    "Limits",
    "Workspace",
    "arm_kind",
    "arm_kind_names",
    "arms_folder",
    "load_robot_file",
]
