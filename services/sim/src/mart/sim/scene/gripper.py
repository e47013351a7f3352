"""Put fingers, or a face that wipes, at the end of an arm. Fingers are two pads that hold by friction alone.

Settled by tests with a 4 cm, 0.1 kg cube: it creeps 0.03 mm in 10 s of holding and 0.25 mm through 5 s of shaking by
3 cm.

- Both fingers are driven by position servos that saturate, so that the force on an object does not depend on its width.
- An equality keeps them centred; without it two saturated fingers have no stiffness along their common axis.
- Heavy joint damping sets how fast they close, six ticks; a lighter one drives the pads through each other.
- impratio and elliptic cones (scenery.py) decide whether things creep; force and friction hardly do.
- Pads have no contact priority: MuJoCo takes the larger condim and friction of a pair, so each object decides whether
  it may pivot between them (GRASPABLE may not; leave out its torsional friction and it will).
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco

from mart.protocol.arms import EndEffector
from mart.protocol.arms.end_effector import Fingers, WipingFace
from mart.protocol.arms.parts import LinkShape
from mart.protocol.tasks import Arm

_SOLREF = (0.004, 1.0)  # the default 0.02 s lets pads sink 4 mm into what they hold
GRASPABLE = {"condim": 4, "friction": (1.0, 0.05, 0.0001), "solref": _SOLREF}  # for an object's geom
WIPES = {
    "friction": (0.3, 0.005, 0.0001),
    "priority": 2,
}  # low, and it counts, or it would drag the hand back

_STIFFNESS_N_PER_M = 2000.0
_ARMATURE_KG = 0.1

AddShape = Callable[[mujoco.MjsBody, LinkShape], None]


def stroke_m(end_effector: EndEffector) -> float:
    """Return how far each finger moves, metres; 0 where there is none."""
    return 0.0 if end_effector.fingers is None else end_effector.fingers.stroke_m


def add_tool(
    spec: mujoco.MjSpec, hand: mujoco.MjsBody, arm: Arm, masks: dict[str, int], look: AddShape
) -> None:
    """Add the site `{arm}/tool`, and fingers with their servos or the face that wipes, to a hand.

    masks: the contact bits of their geoms. look: adds a shape that nothing touches.
    """
    # Turned over, so that the tool's axes are the base's while the hand points straight down: its usual orientations
    # are then far from where a canonical quaternion (w >= 0) jumps.
    end_effector = arm.kind.end_effector
    place = (0, 0, end_effector.tool_z_m)
    hand.add_site(name=f"{arm.name}/tool", pos=place, quat=(0, 1, 0, 0), size=(0.005, 0, 0), group=4)
    if end_effector.fingers is not None:
        for finger in _add_fingers(spec, hand, arm.name, end_effector.fingers):
            _add_pads(finger, end_effector.tool_z_m, end_effector.fingers, masks)
            for shape in end_effector.fingers.shapes:
                look(finger, shape)
    if end_effector.wiping is not None:
        _add_face(hand, end_effector.tool_z_m, end_effector.wiping, masks)


def _add_face(hand: mujoco.MjsBody, z_m: float, face: WipingFace, masks: dict[str, int]) -> None:
    """Add a sponge as thick as the tool's frame is high over its face, on either side."""
    hand.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=(*face.half_m, face.below_tool_m),
        pos=(0, 0, z_m),
        material="sponge",
        **WIPES,
        **masks,
    )


def _add_fingers(
    spec: mujoco.MjSpec, hand: mujoco.MjsBody, arm: str, fingers: Fingers
) -> list[mujoco.MjsBody]:
    """Add both fingers with their servos, and what keeps them centred; return them."""
    added = []
    for side, turn in (("left", (1.0, 0.0, 0.0, 0.0)), ("right", (0.0, 0.0, 0.0, 1.0))):
        finger = hand.add_body(name=f"{arm}/{side}_finger", pos=(0, 0, fingers.z_m), quat=turn)
        finger.mass, finger.ipos, finger.fullinertia, finger.explicitinertial = (
            fingers.mass_kg,
            (0, 0, 0),
            fingers.inertia_kg_m2,
            True,
        )
        finger.add_joint(
            name=f"{arm}/{side}_finger",
            type=mujoco.mjtJoint.mjJNT_SLIDE,
            axis=(0, 1, 0),
            range=(0, fingers.stroke_m),
            armature=_ARMATURE_KG,
            damping=[fingers.force_n / fingers.speed_m_s, 0, 0],
        )
        _add_servo(spec, f"{arm}/{side}_finger", fingers)
        added.append(finger)
    spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT,
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        name1=f"{arm}/left_finger",
        name2=f"{arm}/right_finger",
        data=[0, 1, *[0] * 10],
        solref=_SOLREF,
    )
    return added


def _add_pads(finger: mujoco.MjsBody, tool_z_m: float, fingers: Fingers, masks: dict[str, int]) -> None:
    box, name = mujoco.mjtGeom.mjGEOM_BOX, finger.name.removesuffix("_finger")
    finger.add_geom(
        name=f"{name}_pad",
        type=box,
        size=fingers.pad_half_m,
        pos=(0, fingers.pad_half_m[1], tool_z_m - fingers.z_m),
        solref=_SOLREF,
        group=3,
        **masks,
    )
    finger.add_geom(
        name=f"{name}_knuckle",
        type=box,
        size=fingers.knuckle.half_m,
        pos=fingers.knuckle.center_m,
        condim=1,
        group=3,
        **masks,
    )


def _add_servo(spec: mujoco.MjSpec, joint: str, fingers: Fingers) -> None:
    """Add a servo whose closed end lies beyond the middle, so that it squeezes what is held."""
    servo = spec.add_actuator(
        name=joint,
        target=joint,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        ctrllimited=True,
        ctrlrange=(-fingers.stroke_m, fingers.stroke_m),
        forcelimited=True,
        forcerange=(-fingers.force_n, fingers.force_n),
    )
    servo.set_to_position(kp=_STIFFNESS_N_PER_M)
