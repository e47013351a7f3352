"""Put the bodies of somebody's own MJCF into a room, and nothing else that it brings.

What is left behind, because it would reach into the room or fight the arms' control: lights, cameras, actuators,
keyframes, sensors, numerics, solver settings; planes of its world, where MART's furniture is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import mujoco

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks.conditions import Condition, JointBetween, Still
from mart.protocol.tasks.task_file import TaskFile
from mart.sim.scene.gripper import GRASPABLE
from mart.sim.scene.mjcf_files import SceneSpec, read_scene
from mart.sim.scene.shadows import add_shadow

PREFIX = "scene/"  # of every name of the file, so that none meets one of MART's
_MOST_BODIES, _MOST_GEOMS = 200, 1000
_MOST_RAD = 7.0
_RADIANS_READ_AS_DEGREES = math.radians(math.tau) + 1e-6  # a whole turn in radians, taken for degrees
_OPTIONS = [name for name in dir(mujoco.MjSpec().option) if not name.startswith("_")]
_FREE, _HINGE, _SLIDE = (
    int(kind)
    for kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
)
_LARGEST_SHADOW_M = 0.12


def in_model(name: str) -> str:
    """Return the name in the model of what the file calls so."""
    return f"{PREFIX}{name}"


def add_scene_bodies(spec: mujoco.MjSpec, file: TaskFile) -> None:
    """Add what the file's MJCF holds. Raises InvalidInput and NotFound with what is wrong with it."""
    path = file.mjcf_path
    source = read_scene(path)
    child = source.spec
    try:
        alone = child.copy().compile()
    except ValueError as error:
        raise InvalidInput(f"{path} cannot be compiled: {' '.join(str(error).split())}.") from error
    _check(path, source, alone, file)
    _strip(child, planes=file.scene.furniture)
    _prepare(child, file)
    for name in _OPTIONS:  # the room's hold; MuJoCo warns of every one that differs
        setattr(child.option, name, getattr(spec.option, name))
    spec.attach(child, prefix=PREFIX, frame=spec.worldbody.add_frame())
    if file.scene.furniture:
        for one in file.objects:
            if is_free(alone, one.name):
                add_shadow(spec, in_model(one.name), radius_m=_shadow_m(alone, one.name))


def _prepare(child: mujoco.MjSpec, file: TaskFile) -> None:
    """Let everything that collides meet arms and things, and give what is gripped its friction."""
    for geom in child.geoms:
        bits = int(bool(geom.contype or geom.conaffinity))
        geom.contype, geom.conaffinity = bits, bits
    for one in file.objects:
        body = child.body(one.name)
        for geom in body.find_all(mujoco.mjtObj.mjOBJ_GEOM) if one.grip else ():
            geom.condim, geom.friction, geom.solref = _grip()
        for joint in body.joints:
            if joint.type == mujoco.mjtJoint.mjJNT_FREE:
                joint.name = one.name


def _grip() -> tuple[object, ...]:
    return GRASPABLE["condim"], GRASPABLE["friction"], GRASPABLE["solref"]


def is_free(model: mujoco.MjModel, body: str) -> bool:
    """Return whether a body has a free joint, and nothing else."""
    found = model.body(body)
    return int(found.jntnum[0]) == 1 and int(model.jnt_type[found.jntadr[0]]) == _FREE


def _shadow_m(model: mujoco.MjModel, body: str) -> float:
    found = model.body(body)
    first, count = int(found.geomadr[0]), int(found.geomnum[0])
    bounds = [float(model.geom_rbound[geom]) for geom in range(first, first + count)]
    return min(_LARGEST_SHADOW_M, 1.2 * max(bounds, default=0.03))


def _check(path: Path, source: SceneSpec, alone: mujoco.MjModel, file: TaskFile) -> None:
    if alone.nbody > _MOST_BODIES or alone.ngeom > _MOST_GEOMS:
        raise InvalidInput(
            f"{path} has {alone.nbody} bodies and {alone.ngeom} shapes; {_MOST_BODIES} and {_MOST_GEOMS} are allowed, "
            "or no machine keeps up with the room: leave some out."
        )
    bodies = [alone.body(number).name for number in range(1, alone.nbody)]
    joints = {alone.joint(number).name: int(alone.jnt_type[number]) for number in range(alone.njnt)}
    for one in file.objects:
        if one.name not in bodies:
            raise InvalidInput(str(NotFound.named(f"body of {path.name}", one.name, filter(None, bodies))))
        movable = is_free(alone, one.name) or int(alone.body(one.name).mocapid[0]) >= 0
        if one.spawn is not None and not movable:
            raise InvalidInput(
                f"The body {one.name} of {path} has a spawn, but it is fixed where it is: give it <freejoint/> if arms "
                'may move it, mocap="true" if nothing may, or leave its spawn out.'
            )
    for condition in _conditions(file):
        if isinstance(condition, JointBetween) and joints.get(condition.joint) not in (_HINGE, _SLIDE):
            known = [name for name, kind in joints.items() if kind in (_HINGE, _SLIDE)]
            raise InvalidInput(str(NotFound.named(f"hinge or slide of {path.name}", condition.joint, known)))
        if isinstance(condition, Still) and not is_free(alone, condition.object):
            raise InvalidInput(
                f"The body {condition.object} of {path} has no free joint, so it is always still."
            )
    for number in range(alone.njnt):
        if int(alone.jnt_type[number]) == _HINGE and alone.jnt_limited[number]:
            _check_angles(path, alone.joint(number).name, alone.jnt_range[number].tolist(), source)


def _check_angles(path: Path, joint: str, limits: list[float], source: SceneSpec) -> None:
    low, high = limits
    if max(abs(low), abs(high)) > _MOST_RAD:
        raise InvalidInput(
            f"The joint {joint} of {path} turns from {low:g} to {high:g} rad: that looks like degrees; write them with "
            '<compiler angle="degree"/>.'
        )
    if high - low <= _RADIANS_READ_AS_DEGREES and not source.says_angle:
        raise InvalidInput(
            f"The joint {joint} of {path} turns by {math.degrees(high - low):.2f} degrees alone: a file's angles are "
            'degrees unless it says <compiler angle="radian"/>; say <compiler angle="degree"/> where that is meant.'
        )


def _conditions(file: TaskFile) -> Iterable[Condition]:
    for conditions in (*(one.when for one in file.subtasks), *(one.when for one in file.failures)):
        yield from conditions
    yield from file.success.when or ()


def _strip(child: mujoco.MjSpec, *, planes: bool) -> None:
    for unwanted in (
        *(child.actuators, child.keys, child.cameras, child.lights, child.sensors),
        *(child.numerics, child.texts, child.tuples),
    ):
        for element in list(unwanted):
            child.delete(element)
    for geom in list(child.worldbody.geoms):
        if planes and geom.type == mujoco.mjtGeom.mjGEOM_PLANE:
            child.delete(geom)
    child.meshdir, child.texturedir, child.modelfiledir = "", "", ""
