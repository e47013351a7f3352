"""An arm as other people describe theirs: an MJCF file in degrees, with servos, friction, a floor and a keyframe."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from itertools import starmap
from pathlib import Path

from mart.protocol.arms import arm_kind

KIND = "gen3"  # whose figures it has
ROBOT_FILE = """
title = "Somebody's arm"
home_rad = [0.0, 0.35, 3.1416, -2.1, 0.0, -0.7, 0.0]
meets_things_from_link = 5

[posture]
joint1_sign = -1

[workspace]
radius_min_m = 0.25
reach_m = 0.70
reach_center_z_m = 0.015
z_max_m = 0.5

[placement]
forward_m = 0.06

[mjcf]
file = "their/arm.xml"
joints = ["their_1", "their_2", "their_3", "their_4", "their_5", "their_6", "their_7"]
torques_nm = [39, 39, 39, 39, 9, 9, 9]
site = "flange"
"""
_CORNERS = ((0, 0, 0), (0.05, 0, 0), (0, 0.05, 0), (0, 0, 0.05))
_FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def write_foreign_arm(folder: Path, name: str = "theirs") -> Path:
    """Write the robot file and its MJCF, meshes and all; return the MJCF's path."""
    (folder / "their" / "meshes").mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.toml").write_text(ROBOT_FILE)
    (folder / "their" / "meshes" / "part.stl").write_bytes(_tetrahedron())
    mjcf = folder / "their" / "arm.xml"
    mjcf.write_text(_mjcf())
    return mjcf


def _mjcf() -> str:
    links = arm_kind(KIND).links
    inner = '<site name="flange" pos="0 0 -0.061525" quat="0 1 0 0"/>'
    for number, link in reversed([*enumerate(links, start=1)]):
        low, high = (math.degrees(limit) for limit in link.range_rad)
        limits = "" if high > 359 else f'range="{low:.9g} {high:.9g}"'
        end = "0 -0.1 0" if number % 2 == 0 else "0 0 -0.1"
        inner = (
            f'<body name="their_link{number}" pos="{_row(link.position_m)}" quat="{_row(link.quaternion_wxyz)}">'
            f'<inertial pos="{_row(link.center_of_mass_m)}" mass="{link.mass_kg}" '
            f'fullinertia="{_row(link.inertia_kg_m2)}"/><joint name="their_{number}" {limits}/>'
            f'<geom type="capsule" size=".035" fromto="0 0 0 {end}"/>'
            f'<geom type="mesh" mesh="part" class="picture"/>{inner}</body>'
        )
    servos = "".join(f'<position joint="their_{number}" kp="1000"/>' for number in range(1, 8))
    return (
        '<mujoco model="theirs"><compiler angle="degree" meshdir="meshes"/><option timestep="0.001"/>'
        '<default><joint damping="20" frictionloss="1" stiffness="1"/><geom material="grey"/>'
        '<default class="picture"><geom contype="0" conaffinity="0" group="2"/></default></default>'
        '<asset><mesh name="part" file="part.stl"/><material name="grey" rgba=".2 .2 .2 1"/></asset>'
        '<worldbody><geom name="floor" type="plane" size="1 1 1"/><light pos="0 0 3"/><camera name="theirs"/>'
        f"{inner}</worldbody><actuator>{servos}</actuator>"
        '<keyframe><key name="home" qpos="0 0.35 3.14 -2.1 0 -0.7 0"/></keyframe>'
        '<custom><numeric name="theirs" data="1 2 3"/></custom></mujoco>'
    )


def _row(numbers: Iterable[float]) -> str:
    return " ".join(f"{number:.9g}" for number in numbers)


def _tetrahedron() -> bytes:
    """A binary STL file of four triangles."""
    pack = struct.Struct("<12fH").pack
    triangles = ((0, 0, 0, *_CORNERS[a], *_CORNERS[b], *_CORNERS[c], 0) for a, b, c in _FACES)
    return bytes(80) + struct.pack("<I", len(_FACES)) + b"".join(starmap(pack, triangles))
