"""Model the Franka Hand's fingers: two pads that hold by friction alone.

One gripper serves every task. Settled by tests with a 4 cm, 0.1 kg cube: it creeps 0.03 mm in 10 s of holding and
0.25 mm through 5 s of shaking by 3 cm.

- Both fingers are driven by position servos that saturate, so that the force on an object does not depend on its width.
- An equality keeps them centred; without it two saturated fingers have no stiffness along their common axis.
- Heavy joint damping makes closing take six ticks; a lighter one drives the pads through each other.
- impratio and elliptic cones (scenery.py) decide whether things creep; force and friction hardly do.
- Pads have no contact priority: MuJoCo takes the larger condim and friction of a pair, so each object decides whether
  it may pivot between them (GRASPABLE may not; leave out its torsional friction and it will).
"""

from __future__ import annotations

import mujoco

STROKE_M = 0.04  # of one finger
FINGER_Z_M = 0.0584  # of the finger's frame, in the hand
TOOL_Z_M = 0.103  # of the pads' middle, in the hand (0.210 from link 7)

_SOLREF = (0.004, 1.0)  # the default 0.02 s lets pads sink 4 mm into what they hold
GRASPABLE = {"condim": 4, "friction": (1.0, 0.05, 0.0001), "solref": _SOLREF}  # for an object's geom

_FORCE_N = 30.0
_STIFFNESS_N_PER_M = 2000.0
_DAMPING = 200.0  # N s/m
_ARMATURE_KG = 0.1
_MASS_KG = 0.015
_INERTIA = (2.375e-6, 2.375e-6, 7.5e-7, 0.0, 0.0, 0.0)


def finger_target_m(gripper: float) -> float:
    """Return the servo target for a gripper command, 0 open … 1 closed: beyond the middle it squeezes what is held."""
    return STROKE_M * (1.0 - 2.0 * gripper)


def add_fingers(spec: mujoco.MjSpec, hand: mujoco.MjsBody, arm: str, masks: dict[str, int]) -> None:
    # Turned over, so that the tool's axes are the base's while the hand points straight down: its usual orientations
    # are then far from where a canonical quaternion (w >= 0) jumps.
    """Add fingers, their servos and the site `{arm}/tool` to a hand; `masks`: the contact bits of their geoms."""
    hand.add_site(name=f"{arm}/tool", pos=(0, 0, TOOL_Z_M), quat=(0, 1, 0, 0), size=(0.005, 0, 0), group=4)
    for side, turn in (("left", (1.0, 0.0, 0.0, 0.0)), ("right", (0.0, 0.0, 0.0, 1.0))):
        finger = hand.add_body(name=f"{arm}/{side}_finger", pos=(0, 0, FINGER_Z_M), quat=turn)
        finger.mass, finger.ipos, finger.fullinertia, finger.explicitinertial = (
            _MASS_KG,
            (0, 0, 0),
            _INERTIA,
            True,
        )
        finger.add_joint(
            name=f"{arm}/{side}_finger",
            type=mujoco.mjtJoint.mjJNT_SLIDE,
            axis=(0, 1, 0),
            range=(0, STROKE_M),
            armature=_ARMATURE_KG,
            damping=[_DAMPING, 0, 0],
        )
        _add_pads(finger, f"{arm}/{side}", masks)
        finger.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="detailed/finger",
            material="rubber",
            contype=0,
            conaffinity=0,
        )
        _add_servo(spec, f"{arm}/{side}_finger")
    spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT,
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        name1=f"{arm}/left_finger",
        name2=f"{arm}/right_finger",
        data=[0, 1, *[0] * 10],
        solref=_SOLREF,
    )


def _add_pads(finger: mujoco.MjsBody, name: str, masks: dict[str, int]) -> None:
    box = mujoco.mjtGeom.mjGEOM_BOX
    finger.add_geom(
        name=f"{name}_pad",
        type=box,
        size=(0.009, 0.006, 0.010),
        pos=(0, 0.006, TOOL_Z_M - FINGER_Z_M),
        solref=_SOLREF,
        group=3,
        **masks,
    )
    finger.add_geom(
        name=f"{name}_knuckle",
        type=box,
        size=(0.010, 0.008, 0.017),
        pos=(0, 0.014, 0.0176),
        condim=1,
        group=3,
        **masks,
    )


def _add_servo(spec: mujoco.MjSpec, joint: str) -> None:
    servo = spec.add_actuator(
        name=joint,
        target=joint,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        ctrllimited=True,
        ctrlrange=(-STROKE_M, STROKE_M),
        forcelimited=True,
        forcerange=(-_FORCE_N, _FORCE_N),
    )
    servo.set_to_position(kp=_STIFFNESS_N_PER_M)
