"""Take an arm's links from somebody else's MJCF file: its bodies and shapes, and nothing else that it brings.

What is left behind, because it would reach into the scene or fight the controller: floors, lights, cameras, actuators,
keyframes, sensors, equalities, exclusions and numerics; pictures that no contact uses, materials and textures; joints'
friction, stiffness and damping, which belong to servos that are not ours.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.arms import ArmKind
from mart.protocol.arms.robot_file import ArmModel
from mart.protocol.errors import InvalidInput, NotFound, Unavailable
from mart.protocol.tasks import Arm

_OPTIONS = [name for name in dir(mujoco.MjSpec().option) if not name.startswith("_")]
_MOST_RAD, _LEAST_RAD = 7.0, 0.2
_MOST_TILT_RAD = 0.1
_LEAST_BEFORE_M = 0.1
_MATERIALS_OWN = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's word for: as the material is


def add_links_from_file(
    spec: mujoco.MjSpec, base: mujoco.MjsBody, arm: Arm, masks: Callable[[bool], dict[str, int]]
) -> mujoco.MjsBody:
    """Add the file's bodies below `base`; return the body that is to be the hand.

    masks: contact bits of a link that may meet things, and of one that may not. Raises InvalidInput, Unavailable and
    NotFound with what is wrong with the file.
    """
    kind = arm.kind
    assert kind.mjcf is not None
    path = _path_of(kind.mjcf)
    child, alone = _read(path, kind.mjcf)
    _check(path, alone, kind)
    azimuth_rad, mount_quaternion = _at_home(path, alone, kind)
    _weigh(child, alone)
    _strip(child, path)
    for joint in child.joints:
        joint.frictionloss, joint.stiffness, joint.damping = 0.0, [0.0] * 3, [kind.damping_nm_s, 0.0, 0.0]
        joint.armature = kind.armature_kg_m2
        if joint.name in kind.mjcf.joints:
            _bound(joint, alone.joint(joint.name).range, in_degrees=bool(child.compiler.degree))
    far = _far_bodies(alone, kind)
    for body in child.bodies[1:]:
        bits = masks(body.id in far)
        for geom in body.geoms:
            geom.contype, geom.conaffinity = bits["contype"], bits["conaffinity"]
            geom.material, geom.rgba, geom.group = "", _MATERIALS_OWN, 0
    for picture in (*child.materials, *child.textures):
        child.delete(picture)
    for name in _OPTIONS:  # the scene's hold; MuJoCo warns of every one that differs
        setattr(child.option, name, getattr(spec.option, name))
    prefix = f"{arm.name}/file/"
    ahead = (math.cos(azimuth_rad / 2), 0.0, 0.0, -math.sin(azimuth_rad / 2))
    spec.attach(child, prefix=prefix, frame=base.add_frame(quat=ahead))
    for number, name in enumerate(kind.mjcf.joints, start=1):
        spec.joint(f"{prefix}{name}").name = f"{arm.name}/joint{number}"
    for geom in base.find_all(mujoco.mjtObj.mjOBJ_GEOM):
        geom.material = "shell"
    site = alone.site(kind.mjcf.site)
    parent = spec.site(f"{prefix}{kind.mjcf.site}").parent
    return parent.add_body(name=f"{arm.name}/hand", pos=site.pos, quat=mount_quaternion)


def _path_of(described: ArmModel) -> Path:
    if described.menagerie is None:
        return Path(described.file)
    try:
        menagerie = import_module("mujoco_menagerie")
    except ImportError as error:
        raise Unavailable(
            f"{described.menagerie} is of MuJoCo Menagerie, which is not installed: pip install mart-sim[menagerie]."
        ) from error
    try:
        return Path(menagerie.get(described.menagerie).path(progress=None)) / described.file
    except (menagerie.MenagerieError, OSError) as error:
        raise Unavailable(
            f"{described.menagerie} could not be fetched from MuJoCo Menagerie ({error}); connect this machine to the "
            "internet once, or name another kind of arm."
        ) from error


def _read(path: Path, described: ArmModel) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    """Read a file; return it without what is not wanted, and what it compiles to alone."""
    if not path.is_file():
        raise NotFound(f"There is no {path}; the robot file names it under [mjcf] file.")
    try:
        child = mujoco.MjSpec.from_file(str(path))
        for name in described.remove:
            body = child.body(name)
            if body is None:
                raise InvalidInput(_unknown(path, "body", name, [one.name for one in child.bodies[1:]]))
            child.delete(body)
        return child, child.compile()
    except ValueError as error:
        raise InvalidInput(f"{path} cannot be loaded: {' '.join(str(error).split())}.") from error


def _check(path: Path, alone: mujoco.MjModel, kind: ArmKind) -> None:
    assert kind.mjcf is not None
    joints = [alone.joint(number).name for number in range(alone.njnt)]
    for name in kind.mjcf.joints:
        if name not in joints:
            raise InvalidInput(_unknown(path, "joint", name, joints))
        if int(alone.joint(name).type[0]) != int(mujoco.mjtJoint.mjJNT_HINGE):
            raise InvalidInput(f"The joint {name} of {path} does not turn; an arm's joints are hinges.")
    sites = [alone.site(number).name for number in range(alone.nsite)]
    if kind.mjcf.site not in sites:
        raise InvalidInput(_unknown(path, "site", kind.mjcf.site, sites))
    dofs = [int(alone.joint(name).dofadr[0]) for name in kind.mjcf.joints]
    rows = alone.M_rownnz[dofs].tolist()
    if dofs != [*range(dofs[0], dofs[0] + len(dofs))] or rows != [*range(1, len(dofs) + 1)]:
        raise InvalidInput(
            f"The joints of {path} are no chain from its base: name all that move the tool, base first, and no others "
            "between them; a lift or a mobile base cannot be driven."
        )
    for name, angle in zip(kind.mjcf.joints, kind.home_rad, strict=True):
        _check_range(f"The joint {name} of {path}", alone.joint(name).range.tolist(), angle)


def _check_range(what: str, limits: list[float], home_rad: float) -> None:
    low, high = limits
    if low == high == 0.0:
        return
    if max(abs(low), abs(high)) > _MOST_RAD:
        raise InvalidInput(f"{what} turns from {low:g} to {high:g} rad: that looks like degrees.")
    if high - low < _LEAST_RAD:
        raise InvalidInput(
            f"{what} turns by {high - low:.3f} rad alone: a file's angles are degrees unless it says "
            '<compiler angle="radian"/>.'
        )
    if not low <= home_rad <= high:
        raise InvalidInput(
            f"{what} cannot be at {home_rad:g} rad, where home_rad puts it: {low:g} to {high:g}."
        )


def _unknown(path: Path, what: str, name: str, known: list[str]) -> str:
    return str(NotFound.named(f"{what} of {path.name}", name, known))


def _at_home(path: Path, alone: mujoco.MjModel, kind: ArmKind) -> tuple[float, NDArray[np.float64]]:
    """Return in which direction the tool is at home, and how the hand is turned in its site's body.

    The arm is turned so that the tool is straight ahead, and the hand so that its fingers close along the base's y.
    """
    assert kind.mjcf is not None
    data = mujoco.MjData(alone)
    for name, angle in zip(kind.mjcf.joints, kind.home_rad, strict=True):
        data.joint(name).qpos[0] = angle
    mujoco.mj_kinematics(alone, data)
    site = data.site(kind.mjcf.site).xmat.reshape(3, 3)
    tilt_rad = math.acos(max(-1.0, min(1.0, -float(site[2, 2]))))
    if tilt_rad > _MOST_TILT_RAD:
        raise InvalidInput(
            f"At home_rad the site {kind.mjcf.site} of {path} points {tilt_rad:.2f} rad away from straight down: give "
            "angles with which its z axis points to the table."
        )
    x_m, y_m, _ = data.site(kind.mjcf.site).xpos.tolist()
    if math.hypot(x_m, y_m) < _LEAST_BEFORE_M:
        raise InvalidInput(
            f"At home_rad the site {kind.mjcf.site} of {path} is over the base: give angles with which it is before it."
        )
    azimuth_rad = math.atan2(y_m, x_m)
    twist_rad = math.atan2(float(site[1, 0]), float(site[0, 0])) - azimuth_rad
    turn = np.array([math.cos(twist_rad / 2), 0.0, 0.0, math.sin(twist_rad / 2)])
    quaternion = np.empty(4)
    mujoco.mju_mulQuat(quaternion, alone.site(kind.mjcf.site).quat, turn)
    return azimuth_rad, quaternion


def _strip(child: mujoco.MjSpec, path: Path) -> None:
    for geom in list(child.worldbody.geoms):
        child.delete(geom)
    for unwanted in (
        *(child.actuators, child.keys, child.cameras, child.lights, child.sensors),
        *(child.equalities, child.excludes, child.numerics, child.tendons),
    ):
        for element in list(unwanted):
            child.delete(element)
    if any(geom.contype or geom.conaffinity for body in child.bodies for geom in body.geoms):
        child.discard_visual()
    for mesh in child.meshes:
        if mesh.file:  # as bytes: a path would make the compiled model differ from machine to machine
            child.assets[mesh.file] = (path.parent / child.meshdir / mesh.file).read_bytes()
    child.meshdir, child.texturedir, child.modelfiledir = "", "", ""


def _bound(joint: mujoco.MjsJoint, limits: NDArray[np.float64], *, in_degrees: bool) -> None:
    """Give an endless joint two turns, in its file's own unit: inverse kinematics wants a range."""
    if limits[0] == limits[1] == 0.0:
        turn = 360.0 if in_degrees else math.tau
        joint.limited, joint.range = True, (-turn, turn)


def _weigh(child: mujoco.MjSpec, alone: mujoco.MjModel) -> None:
    """Keep every body's mass and inertia as the file has it, whichever of its shapes go."""
    for body in child.bodies[1:]:
        body.mass, body.ipos, body.iquat = (
            alone.body_mass[body.id],
            alone.body_ipos[body.id],
            alone.body_iquat[body.id],
        )
        body.inertia, body.explicitinertial = alone.body_inertia[body.id], True
        body.fullinertia = [math.nan] * 6  # it says nothing more


def _far_bodies(alone: mujoco.MjModel, kind: ArmKind) -> set[int]:
    """Return the ids of the bodies that may meet things: behind the joint `meets_things_from_link`."""
    assert kind.mjcf is not None
    first = int(alone.jnt_bodyid[alone.joint(kind.mjcf.joints[kind.meets_things_from_link - 1]).id])
    far = {first}
    for body in range(first + 1, alone.nbody):  # parents come first
        if int(alone.body_parentid[body]) in far:
            far.add(body)
    return far
