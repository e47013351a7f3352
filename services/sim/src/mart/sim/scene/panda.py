"""Model the Franka Emika Panda: published figures, and how they become part of a scene.

Kinematics: Franka Control Interface documentation, "Denavit-Hartenberg parameters" (Craig's convention).
Limits: the same, "Limits for Panda": positions in radians, torques in newton metres.
Inertias: Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca, "Dynamic Identification of the Franka Emika Panda Robot With
Retrieval of Feasible Parameters Using Penalty-Based Optimization", IEEE RA-L 4(4), 2019.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mart.protocol.tasks import MAX_ARMS, Arm
from mart.sim.scene import gripper
from mart.sim.scene.meshes import Detail, mesh_path
from mart.sim.scene.palette import rgba
from mart.sim.scene.symbols import add_tile

_MINUS_X, _PLUS_X, _STRAIGHT = (1.0, -1.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PandaLink:
    """Describe link and joint before it; `inertia`: xx yy zz xy xz yz at its mass centre, kg m², link frame."""

    position_in_parent: tuple[float, float, float]
    quaternion_in_parent: tuple[float, float, float, float]
    joint_range_rad: tuple[float, float]
    torque_nm: float
    mass_kg: float
    center_of_mass: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]


_BASE_MASS = (
    0.629769,
    (-0.041018, -0.00014, 0.049974),
    (0.00315, 0.00388, 0.004285, 8.29e-7, 0.00015, 8.23e-6),
)
_HAND_MASS = (0.73, (-0.01, 0.0, 0.03), (0.001, 0.0025, 0.0017, 0.0, 0.0, 0.0))

LINKS = (
    PandaLink((0, 0, 0.333), _STRAIGHT, (-2.8973, 2.8973), 87, 4.970684, (0.003875, 0.002081, -0.04762),
         (0.70337, 0.70661, 0.0091170, -0.000139, 0.006772, 0.019169)),
    PandaLink((0, 0, 0), _MINUS_X, (-1.7628, 1.7628), 87, 0.646926, (-0.003141, -0.02872, 0.003495),
         (0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704)),
    PandaLink((0, -0.316, 0), _PLUS_X, (-2.8973, 2.8973), 87, 3.228604, (0.027518, 0.039252, -0.066502),
         (0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805)),
    # The datasheet ends joint 4 at -0.0698. Its axis lies beside the line from shoulder to wrist, so the arm is longest
    # at -0.467; beyond, straightening pulls the wrist in, and an arm that is called back meets the stop and stays.
    PandaLink((0.0825, 0, 0), _PLUS_X, (-3.0718, -0.50), 87, 3.587895, (-0.05317, 0.104419, 0.027454),
         (0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641)),
    PandaLink((-0.0825, 0.384, 0), _MINUS_X, (-2.8973, 2.8973), 12, 1.225946, (-0.011953, 0.041065, -0.038437),
         (0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229)),
    PandaLink((0, 0, 0), _PLUS_X, (-0.0175, 3.7525), 12, 1.666555, (0.060149, -0.014117, -0.010517),
         (0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341)),
    PandaLink((0.088, 0, 0), _PLUS_X, (-2.8973, 2.8973), 12, 0.735522, (0.010517, -0.004252, 0.061597),
         (0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741)),
)  # fmt: skip

_FLANGE_Z_M = 0.107  # of the hand's mounting face, in link 7
_HAND_TURN = (0.9238795, 0.0, 0.0, -0.3826834)  # the hand is mounted at -45 degrees
_ARMATURE = 0.1  # rotor inertia seen at the joint, kg m²
_DAMPING = 0.5  # N m s/rad; compensated by the controller

# A comfortable elbow-up posture, tool down, from which inverse kinematics starts.
HOME_RAD = (0.0, 0.2, 0.0, -2.1, 0.0, 2.3, 0.785)


def add_assets(spec: mujoco.MjSpec, detail: Detail) -> None:
    """Add the meshes, once for all arms: `hull/…` for contacts and, where asked, `detailed/…` to look at."""
    for level in dict.fromkeys(("hull", detail)):
        for part in (*(f"link{i}" for i in range(8)), "hand"):
            _add_mesh(spec, part, level)
    _add_mesh(spec, "finger", "detailed")  # 600 triangles, and the part that everybody looks at


def _add_mesh(spec: mujoco.MjSpec, part: str, level: Detail) -> None:
    # Given as bytes: a path would end up in the compiled model and make its hash differ from machine to machine.
    file = f"{level}-{part}.stl"
    spec.assets[file] = mesh_path(part, level).read_bytes()
    spec.add_mesh(name=f"{level}/{part}", file=file)


def add_panda(spec: mujoco.MjSpec, arm: Arm, index: int, detail: Detail) -> None:
    """Add the arm with its gripper, joints, motors and the site `{arm}/tool` at the middle of the finger pads."""
    body = spec.worldbody.add_body(
        name=f"{arm.name}/base",
        pos=arm.pose_base_in_world.position,
        quat=arm.pose_base_in_world.quaternion_wxyz,
    )
    _set_inertia(body, *_BASE_MASS)
    _add_shell(body, "link0", detail, _masks(index, reaches_objects=False))
    for number, link in enumerate(LINKS, start=1):
        body = body.add_body(
            name=f"{arm.name}/link{number}", pos=link.position_in_parent, quat=link.quaternion_in_parent
        )
        _set_inertia(body, link.mass_kg, link.center_of_mass, link.inertia)
        body.add_joint(
            name=f"{arm.name}/joint{number}",
            axis=(0, 0, 1),
            range=link.joint_range_rad,
            armature=_ARMATURE,
            damping=[_DAMPING, 0, 0],
        )
        _add_shell(body, f"link{number}", detail, _masks(index, reaches_objects=number >= 5))
        _add_motor(spec, arm.name, number, link.torque_nm)
    hand = body.add_body(name=f"{arm.name}/hand", pos=(0, 0, _FLANGE_Z_M), quat=_HAND_TURN)
    _set_inertia(hand, *_HAND_MASS)
    _add_shell(hand, "hand", detail, _masks(index, reaches_objects=True), rgba(arm.color))
    for side in (-1, 1):
        position = (0.0325 * side, 0.0, 0.018)
        add_tile(spec, hand, arm.symbol, radius_m=0.016, position=position, normal=(side, 0, 0))
    gripper.add_fingers(spec, hand, arm.name, _masks(index, reaches_objects=True))


def _masks(index: int, *, reaches_objects: bool) -> dict[str, int]:
    """Return contact bits: things 1, arm i's far links 2 << i.

    Arms meet each other, never themselves; an arm's near links cannot meet the things on the table.
    """
    own = 2 << index
    others = sum(2 << other for other in range(MAX_ARMS) if other != index)
    return (
        {"contype": own, "conaffinity": others | 1}
        if reaches_objects
        else {"contype": 0, "conaffinity": others}
    )


def _set_inertia(
    body: mujoco.MjsBody, mass: float, center: tuple[float, ...], inertia: tuple[float, ...]
) -> None:
    body.mass, body.ipos, body.fullinertia, body.explicitinertial = mass, center, inertia, True


def _add_shell(
    body: mujoco.MjsBody, part: str, detail: Detail, masks: dict[str, int], color: np.ndarray | None = None
) -> None:
    look = {"material": "shell"} if color is None else {"material": "shell", "rgba": color}
    mesh = mujoco.mjtGeom.mjGEOM_MESH
    if detail == "hull":
        body.add_geom(type=mesh, meshname=f"hull/{part}", **look, **masks)
        return
    body.add_geom(type=mesh, meshname=f"detailed/{part}", contype=0, conaffinity=0, **look)
    body.add_geom(type=mesh, meshname=f"hull/{part}", group=3, **masks)


def _add_motor(spec: mujoco.MjSpec, arm: str, number: int, torque_nm: float) -> None:
    spec.add_actuator(
        name=f"{arm}/torque{number}",
        target=f"{arm}/joint{number}",
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        ctrllimited=True,
        ctrlrange=(-torque_nm, torque_nm),
    )
