"""Put an arm into a scene, as its robot file describes it: links, joints, motors, and what it holds at its end."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import mujoco

from mart.protocol.arms.end_effector import SymbolPlace
from mart.protocol.arms.parts import ArmBody, LinkBox, LinkMesh, LinkShape, LinkSphere, LinkTube
from mart.protocol.tasks import MAX_ARMS, Arm
from mart.sim.scene import gripper
from mart.sim.scene.arm_from_file import add_links_from_file
from mart.sim.scene.meshes import Detail, mesh_path
from mart.sim.scene.palette import rgba
from mart.sim.scene.symbols import add_tile

_GEOMS = {
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}


def add_assets(spec: mujoco.MjSpec, arms: Sequence[Arm], detail: Detail) -> None:
    """Add the meshes, once for all arms: `hull/…` for contacts and, where asked, `detailed/…` to look at."""
    hands = [arm.kind.end_effector for arm in arms]
    bodies = [body for arm in arms for body in (arm.kind.base, *arm.kind.links) if body is not None]
    parts = _parts(shape for body in (*bodies, *hands) for shape in body.shapes)
    for level in dict.fromkeys(("hull", detail)):
        for part in parts:
            _add_mesh(spec, part, level)
    for part in _parts(shape for hand in hands if hand.fingers is not None for shape in hand.fingers.shapes):
        _add_mesh(spec, part, "detailed")  # 600 triangles, and the part that everybody looks at


def _parts(shapes: Iterable[LinkShape]) -> list[str]:
    return list(dict.fromkeys(shape.part for shape in shapes if isinstance(shape, LinkMesh)))


def _add_mesh(spec: mujoco.MjSpec, part: str, level: Detail) -> None:
    # Given as bytes: a path would end up in the compiled model and make its hash differ from machine to machine.
    file = f"{level}-{part}.stl"
    spec.assets[file] = mesh_path(part, level).read_bytes()
    spec.add_mesh(name=f"{level}/{part}", file=file)


def add_arm(spec: mujoco.MjSpec, arm: Arm, index: int, detail: Detail) -> None:
    """Add the arm with its joints, motors, end effector and the site `{arm}/tool`."""
    base = spec.worldbody.add_body(
        name=f"{arm.name}/base",
        pos=arm.pose_base_in_world.position,
        quat=arm.pose_base_in_world.quaternion_wxyz,
    )
    if arm.kind.mjcf is None:
        hand = _add_links(spec, base, arm, index, detail)
    else:
        hand = add_links_from_file(spec, base, arm, lambda far: _masks(index, reaches_objects=far))
    for number, torque_nm in enumerate(arm.kind.torques_nm, start=1):
        _add_motor(spec, arm.name, number, torque_nm)
    _add_hand(spec, hand, arm, index, detail)


def _add_links(
    spec: mujoco.MjSpec, base: mujoco.MjsBody, arm: Arm, index: int, detail: Detail
) -> mujoco.MjsBody:
    """Add the links that the robot file describes; return the body that is to be the hand."""
    kind, body = arm.kind, base
    assert kind.base is not None
    _fill(body, kind.base, arm, detail, _masks(index, reaches_objects=False))
    for number, link in enumerate(kind.links, start=1):
        body = body.add_body(name=f"{arm.name}/link{number}", pos=link.position_m, quat=link.quaternion_wxyz)
        body.add_joint(
            name=f"{arm.name}/joint{number}",
            axis=(0, 0, 1),
            range=link.range_rad,
            armature=kind.armature_kg_m2,
            damping=[kind.damping_nm_s, 0, 0],
        )
        far = number >= kind.meets_things_from_link
        _fill(body, link, arm, detail, _masks(index, reaches_objects=far))
    return body.add_body(name=f"{arm.name}/hand", pos=kind.mount.position_m, quat=kind.mount.quaternion_wxyz)


def _add_hand(spec: mujoco.MjSpec, hand: mujoco.MjsBody, arm: Arm, index: int, detail: Detail) -> None:
    masks, end_effector = _masks(index, reaches_objects=True), arm.kind.end_effector
    _fill(hand, end_effector, arm, detail, masks)
    if end_effector.symbol is not None:
        _add_symbols(spec, hand, arm.symbol, end_effector.symbol)
    gripper.add_tool(spec, hand, arm, masks, lambda body, shape: _add_look(body, shape, arm))


def _add_symbols(spec: mujoco.MjSpec, hand: mujoco.MjsBody, symbol: str, place: SymbolPlace) -> None:
    for side in (-1, 1):
        position = (place.x_m * side, 0.0, place.z_m)
        add_tile(spec, hand, symbol, radius_m=place.radius_m, position=position, normal=(side, 0, 0))


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


def _fill(body: mujoco.MjsBody, described: ArmBody, arm: Arm, detail: Detail, masks: dict[str, int]) -> None:
    _set_inertia(body, described.mass_kg, described.center_of_mass_m, described.inertia_kg_m2)
    for shape in described.shapes:
        _add_shape(body, shape, arm, detail, masks)


def _set_inertia(
    body: mujoco.MjsBody, mass: float, center: tuple[float, ...], inertia: tuple[float, ...]
) -> None:
    body.mass, body.ipos, body.fullinertia, body.explicitinertial = mass, center, inertia, True


def _add_shape(
    body: mujoco.MjsBody, shape: LinkShape, arm: Arm, detail: Detail, masks: dict[str, int]
) -> None:
    look = _look(shape, arm)
    if isinstance(shape, LinkMesh):
        _add_shell(body, shape.part, detail, masks, look)
    else:
        body.add_geom(type=_GEOMS[shape.form], **_extent(shape), **look, **masks)


def _add_look(body: mujoco.MjsBody, shape: LinkShape, arm: Arm) -> None:
    """Add a shape that nothing touches."""
    look = {**_look(shape, arm), "contype": 0, "conaffinity": 0}
    if isinstance(shape, LinkMesh):
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"detailed/{shape.part}", **look)
    else:
        body.add_geom(type=_GEOMS[shape.form], **_extent(shape), **look)


def _look(shape: LinkShape, arm: Arm) -> dict[str, object]:
    """Return material and colour; a mesh keeps its own material, tinted, where others are painted."""
    painted = "paint" if not isinstance(shape, LinkMesh) else shape.material
    return {"material": painted, "rgba": rgba(arm.color)} if shape.accent else {"material": shape.material}


def _extent(shape: LinkTube | LinkBox | LinkSphere) -> dict[str, tuple[float, ...]]:
    if isinstance(shape, LinkTube):
        return {"fromto": (*shape.from_m, *shape.to_m), "size": (shape.radius_m, 0, 0)}
    size = shape.half_m if isinstance(shape, LinkBox) else (shape.radius_m, 0, 0)
    return {"pos": shape.center_m, "size": size}


def _add_shell(
    body: mujoco.MjsBody, part: str, detail: Detail, masks: dict[str, int], look: dict[str, object]
) -> None:
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
