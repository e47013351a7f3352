"""Drive one kind of arm through what tasks will ask of it, and say in words how it stands (`mart arms check`)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mart.protocol.arms import PANDA, ArmKind
from mart.protocol.errors import InvalidInput, MartError, NotFound
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task, get_task, task_names
from mart.sim.experts.run_experts import run_experts
from mart.sim.scene.data import Array
from mart.sim.tasks import scene_of
from mart.sim.world.reach import missed
from mart.sim.world.world import World

_TASK = "two_arm_multi_cube_lifting"  # where an arm is looked at alone
_FINGERLESS_TASK = "three_arm_lift_wiping"  # the same where it has no fingers
_LOAD_KG = 0.5
_GRAVITY = 9.81
_MOST_SAG_M = 0.015
_LEAST_MARGIN_RAD = 0.05
_MOST_TORQUE_SHARE = 0.9
# Of the tool, along and about the axes of the base; with the tool straight down, x is the way it reaches.
_DIRECTIONS = (
    *("shifts forward", "shifts sideways", "shifts up"),
    *("tilts to the side (turns about x)", "tilts forward (turns about y)", "turns about the vertical"),
)
_STEP_M = 0.05
_RIGHT_M = 0.003
_SETTLE_TICKS = 30
_CONTROL_HZ = 20.0
_SEED = 0


@dataclass(frozen=True)
class ArmFinding:
    """Tell of one thing that was looked at. what: reach, payload, …; said: what was found, in words."""

    what: str
    ok: bool
    said: str


def check_arm(kind: ArmKind) -> Iterator[ArmFinding]:
    """Look at one thing after another; the first that keeps the others from being looked at is the last."""
    try:
        world = _world_of(get_task(_TASK if kind.has_fingers else _FINGERLESS_TASK), kind)
        world.reset(_SEED)
    except (MartError, ValueError) as error:  # what MuJoCo cannot compile is a ValueError, in its own words
        yield ArmFinding("loads", ok=False, said=str(error))
        return
    said = f"{kind.title}: {kind.joint_count} joints; at its end {kind.end_effector.about}."
    yield ArmFinding("loads", ok=True, said=said)
    yield from _alone(world, kind)
    for name in task_names():
        yield _in_task(get_task(name), kind)


def _world_of(task: Task, kind: ArmKind) -> World:
    """Return the task's world with this kind at every place; without fingers, at those that need none."""
    kinds = [kind if _fits(task, arm.name, kind) else PANDA for arm in task.arms]
    return World(scene_of(task.with_kinds(kinds)), _CONTROL_HZ)


def _fits(task: Task, arm: str, kind: ArmKind) -> bool:
    return kind.has_fingers or arm in task.fingerless


def _own(world: World, kind: ArmKind) -> str:
    """Return the name of the first arm of this kind."""
    return next(arm.name for arm in world.task.arms if arm.kind == kind)


def _alone(world: World, kind: ArmKind) -> Iterator[ArmFinding]:
    mujoco.mj_forward(world.model, world.data)
    own = _own(world, kind)
    joint = world.model.joint(f"{own}/joint1")
    first, count = int(joint.dofadr[0]), kind.joint_count
    dofs = slice(first, first + count)
    yield _limits(world, kind, joint.id, int(joint.qposadr[0]))
    jacobian, mass = np.zeros((6, world.model.nv)), np.zeros((world.model.nv, world.model.nv))
    site = world.model.site(f"{own}/tool").id
    mujoco.mj_jacSite(world.model, world.data, jacobian[:3], jacobian[3:], site)
    mujoco.mj_fullM(world.model, world.data, mass)
    mobility = jacobian[:, dofs] @ np.linalg.inv(mass[dofs, dofs]) @ jacobian[:, dofs].T
    torques = np.array(kind.torques_nm)
    load = jacobian[2, dofs] * _LOAD_KG * _GRAVITY
    yield _payload(kind, mobility, np.abs(world.data.qfrc_bias[dofs] + load) / torques)
    yield _singularity(kind, mobility)
    yield _response(world, own)


def _limits(world: World, kind: ArmKind, first: int, qpos: int) -> ArmFinding:
    joints = world.data.qpos[qpos : qpos + kind.joint_count]
    ranges = world.model.jnt_range[first : first + kind.joint_count]
    margins = np.minimum(joints - ranges[:, 0], ranges[:, 1] - joints)
    nearest = int(np.argmin(margins))
    margin_deg = np.degrees(margins[nearest])
    said = f"Where episodes begin, joint {nearest + 1} is nearest to a stop: {margin_deg:.0f} degrees."
    return ArmFinding("limits", bool(margins[nearest] > _LEAST_MARGIN_RAD), said)


def _payload(kind: ArmKind, mobility: Array, shares: Array) -> ArmFinding:
    sag_m = _LOAD_KG * _GRAVITY * float(mobility[2, 2]) / kind.gains.kp_position
    hardest = int(shares.argmax())
    said = (
        f"{_LOAD_KG:g} kg in its hand let it sag by {1000 * sag_m:.1f} mm; joint {hardest + 1} holds it with "
        f"{100 * shares[hardest]:.0f} % of its torque."
    )
    return ArmFinding("payload", sag_m < _MOST_SAG_M and bool(shares[hardest] < _MOST_TORQUE_SHARE), said)


def _singularity(kind: ArmKind, mobility: Array) -> ArmFinding:
    gains = kind.gains
    scale = np.sqrt(np.repeat([gains.regular_mobility_position, gains.regular_mobility_orientation], 3))
    mobilities, directions = np.linalg.eigh(mobility / np.outer(scale, scale))
    least = float(mobilities[0])
    if kind.joint_count < len(directions):
        return _given_up(kind, directions[:, : len(directions) - kind.joint_count], mobilities)
    lost = "" if least >= 1 else "; below 1 a direction counts as lost and is damped"
    said = f"Where episodes begin, its least mobile direction has {least:.1f} times what is regular{lost}."
    return ArmFinding("singularity", least >= 1, said)


def _given_up(kind: ArmKind, lost: Array, mobilities: Array) -> ArmFinding:
    """Say which directions an arm with fewer joints than six gives up; lost: those, shape (6, n), each of length 1."""
    named = [_DIRECTIONS[int(np.argmax(np.abs(direction)))] for direction in lost.T]
    kept = float(mobilities[lost.shape[1]])
    damped = "" if kept >= 1 else "; below 1 a direction counts as lost and is damped"
    said = (
        f"Its {kind.joint_count} joints give up {', '.join(named)} where episodes begin, and keep the rest: there its "
        f"least mobile direction has {kept:.1f} times what is regular{damped}."
    )
    return ArmFinding("singularity", kept >= 1, said)


def _response(world: World, own: str) -> ArmFinding:
    """Step the tool by 5 cm along each axis of the base, and look where it comes to rest and how far beyond it went."""
    worst_m, beyond = 0.0, 0.0
    for axis in range(3):
        world.reset(_SEED)
        start = {arm: world.tool_pose_in_base(arm) for arm in world.arms}
        shift = _STEP_M * np.eye(3)[axis]
        goals = start | {own: Pose(start[own].position + shift, start[own].quaternion_wxyz)}
        for _ in range(_SETTLE_TICKS):
            world.step([world.action_for(arm, goal, 0.0) for arm, goal in goals.items()])
            along = float((world.tool_pose_in_base(own).position - start[own].position)[axis]) / _STEP_M
            beyond = max(beyond, along - 1.0)
        worst_m = max(worst_m, goals[own].distance_to(world.tool_pose_in_base(own))[0])
    after_s = _SETTLE_TICKS / _CONTROL_HZ
    said = f"Steps of 5 cm end within {1000 * worst_m:.1f} mm in {after_s:g} s, {100 * beyond:.1f} % beyond."
    return ArmFinding("response", worst_m < _RIGHT_M and beyond < 0.02, said)


def _in_task(task: Task, kind: ArmKind) -> ArmFinding:
    """Look at a task with this kind at every place: what is out of reach, and whether scripts can do it."""
    if not any(_fits(task, arm, kind) for arm in task.arm_names):
        return ArmFinding(
            "fingers",
            ok=True,
            said=f"{task.title}: it has no fingers to grip with, and its rooms do not open.",
        )
    try:
        world = _world_of(task, kind)
        out_of_reach = missed(world)
        if out_of_reach:
            worst = max(out_of_reach, key=lambda one: one.by_m)
            said = f"{task.title}: {worst.arm} misses {worst.thing} by {100 * worst.by_m:.0f} cm."
            return ArmFinding("reach", ok=False, said=said)
        progress = run_experts(world, _SEED, until_s=world.task.trial_limit_s)
    except NotFound:
        return ArmFinding(
            "reach", ok=True, said=f"{task.title}: within reach; there is no script to try it with."
        )
    except InvalidInput as error:
        return ArmFinding("reach", ok=False, said=f"{task.title}: {error}")
    if progress.success:
        return ArmFinding("reach", ok=True, said=f"{task.title}: scripts did it in {world.sim_time_s:.1f} s.")
    open_ones = ", ".join(name for name, done in progress.subtasks.items() if not done)
    return ArmFinding(
        "reach", ok=False, said=f"{task.title}: within reach, but scripts did not do it ({open_ones})."
    )


def draw_arm(kind: ArmKind, draw: Callable[[World, str], None]) -> None:
    """Show the arm where cubes are lifted, beside another of its kind; `draw` is given the world and a viewpoint."""
    world = _world_of(get_task(_TASK if kind.has_fingers else _FINGERLESS_TASK), kind)
    world.reset(_SEED)
    for viewpoint in ("front", _own(world, kind)):
        draw(world, viewpoint)


def verdict(findings: list[ArmFinding]) -> str:
    """Return in a sentence whether the arm can be used."""
    bad = [finding for finding in findings if not finding.ok]
    tasks = [finding for finding in findings if finding.what in ("reach", "fingers")]
    usable = [finding for finding in tasks if finding.ok and finding.what == "reach"]
    if not bad and len(usable) == len(tasks):
        return "It can be used in every task."
    if any(finding.what == "loads" for finding in bad):
        return "It cannot be used as it is: mend what is marked BAD."
    if all(finding.what == "reach" for finding in bad):
        return f"It can be used in {len(usable)} of {len(tasks)} tasks."
    return "It can be used, but look at what is marked BAD."
