"""What the person sees move is what they moved; a press moves nothing; an open clutch holds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mart.protocol.pose import Pose, quaternion_multiply, rotate
from mart.teleop_gateway.emulation.emulated_hand import resting_pose
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.retarget import Retarget, azimuth_of_camera_rad, heading_rad, session_to_base
from mart.teleop_gateway.input.tool_motion import ToolMotion
from tests.teleop_gateway.input.strategies import angles_rad, hand, poses, positions, quaternions

HOME = Pose(np.array([0.5, 0.0, 0.3]), np.array([0.0, 1.0, 0.0, 0.0]))
REST = ToolMotion(HOME)
scales = st.floats(0.2, 2.0)


def assert_same(a: Pose, b: Pose) -> None:
    metres, radians = a.distance_to(b)
    assert metres < 1e-9
    assert radians < 1e-6


@given(poses, poses, angles_rad)
def test_pressing_moves_nothing(phone: Pose, tool: Pose, azimuth_rad: float) -> None:
    retarget = Retarget(azimuth_rad)
    retarget.follow(hand(phone, clutch=False), REST)
    target = retarget.follow(hand(phone, clutch=True), ToolMotion(tool))
    assert_same(target.pose_tool_in_base, tool)
    assert target.engaged
    again = retarget.follow(hand(phone, clutch=True), REST)
    assert_same(again.pose_tool_in_base, tool)


@given(st.lists(st.tuples(poses, st.booleans(), poses), min_size=1, max_size=12), angles_rad)
def test_an_open_clutch_asks_for_where_the_tool_is_until_it_rests_and_then_for_nothing_else(
    steps: list[tuple[Pose, bool, Pose]], azimuth_rad: float
) -> None:
    """A second passes between two steps: a tool that was let go rests by then."""
    retarget = Retarget(azimuth_rad)
    held: Pose | None = None
    for second, (phone, clutch, tool) in enumerate(steps):
        target = retarget.follow(hand(phone, clutch=clutch), ToolMotion(tool, float(second)))
        assert target.engaged == clutch
        if clutch:
            held = None
            continue
        if held is None:
            assert_same(target.pose_tool_in_base, tool)
        settled = retarget.follow(hand(phone, clutch=False), ToolMotion(tool, second + 0.6))
        assert_same(settled.pose_tool_in_base, held or tool)
        held = settled.pose_tool_in_base


@given(positions, positions, angles_rad, angles_rad, scales)
def test_a_motion_keeps_its_length_its_height_and_its_side(
    start: tuple[float, float, float],
    shift: tuple[float, float, float],
    phone_heading_rad: float,
    azimuth_rad: float,
    scale: float,
) -> None:
    """Seen with the phone's heading, right, up and towards are camera right, up and towards, times the scale."""
    retarget = Retarget(azimuth_rad, scale)
    pose = Pose(np.array(start), resting_pose(phone_heading_rad).quaternion_wxyz)
    retarget.follow(hand(pose, clutch=True), REST)
    about_up = np.array([math.cos(phone_heading_rad / 2), 0.0, math.sin(phone_heading_rad / 2), 0.0])
    moved = Pose(pose.position + rotate(about_up, np.array(shift)), pose.quaternion_wxyz)
    target = retarget.follow(hand(moved, clutch=True), REST)
    right, up, towards = shift
    ahead = np.array([math.cos(azimuth_rad), math.sin(azimuth_rad), 0.0])
    right_of = np.array([math.sin(azimuth_rad), -math.cos(azimuth_rad), 0.0])
    expected = scale * (right * right_of - towards * ahead + np.array([0.0, 0.0, up]))
    np.testing.assert_allclose(target.pose_tool_in_base.position - HOME.position, expected, atol=1e-9)
    np.testing.assert_allclose(target.pose_tool_in_base.rotation_matrix(), HOME.rotation_matrix(), atol=1e-9)


@given(quaternions, angles_rad, angles_rad)
def test_a_turn_keeps_its_angle(turn: np.ndarray, phone_heading_rad: float, azimuth_rad: float) -> None:
    retarget = Retarget(azimuth_rad)
    start = resting_pose(phone_heading_rad)
    retarget.follow(hand(start, clutch=True), REST)
    moved = Pose(start.position, quaternion_multiply(turn, start.quaternion_wxyz))
    target = retarget.follow(hand(moved, clutch=True), REST)
    _, asked_rad = moved.distance_to(start)
    metres, done_rad = target.pose_tool_in_base.distance_to(HOME)
    assert done_rad == pytest.approx(asked_rad, abs=1e-6)
    assert metres < 1e-12


@given(angles_rad, st.floats(-0.5, 0.5))
def test_the_session_may_start_anywhere(session_yaw_rad: float, shift_m: float) -> None:
    """Turning the whole session, phone and motion alike, changes nothing."""
    turn = np.array([math.cos(session_yaw_rad / 2), 0.0, math.sin(session_yaw_rad / 2), 0.0])
    session = Pose(np.array([0.3, -0.2, 0.1]), turn)
    start, step = resting_pose(0.0), Pose(np.array([shift_m, 0.1, -0.2]), np.array([0.9, 0.3, 0.1, 0.3]))
    moved = Pose(start.position + step.position, (step @ start).quaternion_wxyz)
    targets = []
    for frame in (Pose.identity(), session):
        retarget = Retarget(0.4)
        retarget.follow(hand(frame @ start, clutch=True), REST)
        targets.append(retarget.follow(hand(frame @ moved, clutch=True), REST).pose_tool_in_base)
    assert_same(*targets)


@given(poses, positions, angles_rad)
def test_a_screen_aligned_pose_needs_no_heading(
    phone: Pose, shift: tuple[float, float, float], azimuth_rad: float
) -> None:
    retarget = Retarget(azimuth_rad)
    retarget.follow(hand(phone, clutch=True, more=Flag.SCREEN_ALIGNED), REST)
    moved = Pose(phone.position + np.array(shift), phone.quaternion_wxyz)
    target = retarget.follow(hand(moved, clutch=True, more=Flag.SCREEN_ALIGNED), REST)
    expected = rotate(session_to_base(0.0, azimuth_rad), np.array(shift))
    np.testing.assert_allclose(target.pose_tool_in_base.position - HOME.position, expected, atol=1e-9)


@given(angles_rad, positions)
def test_a_touch_pad_is_aligned_though_the_phone_is_not(
    phone_heading_rad: float, shift: tuple[float, float, float]
) -> None:
    retarget = Retarget(0.0)
    start = resting_pose(phone_heading_rad)
    retarget.follow(hand(start, clutch=True, more=Flag.ORIENTATION_ONLY), REST)
    pitch = np.array([math.cos(0.2), *(math.sin(0.2) * _right_of(phone_heading_rad))])
    moved = Pose(start.position + np.array(shift), quaternion_multiply(pitch, start.quaternion_wxyz))
    target = retarget.follow(hand(moved, clutch=True, more=Flag.ORIENTATION_ONLY), REST).pose_tool_in_base
    right, up, towards = shift
    np.testing.assert_allclose(target.position - HOME.position, (-towards, -right, up), atol=1e-9)
    # Tilting the phone's top towards its holder turns the tool about the axis to the right, wherever they face.
    turn = Pose(np.zeros(3), quaternion_multiply(target.quaternion_wxyz, HOME.inverse().quaternion_wxyz))
    np.testing.assert_allclose(turn.quaternion_wxyz[1:] / math.sin(0.2), (0.0, -1.0, 0.0), atol=1e-6)


@given(poses, poses, poses)
def test_after_a_reset_the_references_are_taken_anew(phone: Pose, moved: Pose, tool: Pose) -> None:
    retarget = Retarget(0.3)
    retarget.follow(hand(phone, clutch=True), REST)
    retarget.follow(hand(moved, clutch=True), REST)
    retarget.forget()
    assert_same(retarget.follow(hand(moved, clutch=True), ToolMotion(tool)).pose_tool_in_base, tool)
    retarget.forget()
    assert_same(retarget.follow(hand(phone, clutch=False), ToolMotion(tool)).pose_tool_in_base, tool)


def test_the_gripper_follows_whatever_the_clutch_does() -> None:
    retarget = Retarget(0.0)
    for clutch, gripper in ((False, 0.2), (True, 0.4), (False, 1.0)):
        assert retarget.follow(hand(Pose.identity(), clutch=clutch, gripper=gripper), REST).gripper == gripper


@given(angles_rad, st.floats(0.0, math.pi / 2))
def test_heading_is_that_of_a_phone_held_anywhere_from_upright_to_flat(
    yaw_rad: float, pitch_rad: float
) -> None:
    found = heading_rad(resting_pose(yaw_rad, pitch_rad))
    assert math.cos(found - yaw_rad) == pytest.approx(1.0, abs=1e-9)


@given(angles_rad, st.floats(0.0, math.pi / 2))
def test_azimuth_is_that_of_a_camera_looking_ahead_or_down(azimuth_rad: float, down_rad: float) -> None:
    level = Pose(np.zeros(3), session_to_base(0.0, azimuth_rad))
    tilt = Pose(np.zeros(3), np.array([math.cos(down_rad / 2), -math.sin(down_rad / 2), 0.0, 0.0]))
    found = azimuth_of_camera_rad(level @ tilt)
    assert math.cos(found - azimuth_rad) == pytest.approx(1.0, abs=1e-9)


@given(angles_rad, angles_rad)
def test_session_to_base_is_a_rotation_that_keeps_up(phone_heading_rad: float, azimuth_rad: float) -> None:
    turn = session_to_base(phone_heading_rad, azimuth_rad)
    assert np.linalg.norm(turn) == pytest.approx(1.0)
    np.testing.assert_allclose(rotate(turn, np.array([0.0, 1.0, 0.0])), (0.0, 0.0, 1.0), atol=1e-12)
    ahead = np.array([-math.sin(phone_heading_rad), 0.0, -math.cos(phone_heading_rad)])
    expected = (math.cos(azimuth_rad), math.sin(azimuth_rad), 0.0)
    np.testing.assert_allclose(rotate(turn, ahead), expected, atol=1e-12)


@given(poses, poses)
def test_targets_are_always_sound(phone: Pose, moved: Pose) -> None:
    assume(phone.distance_to(moved)[0] < 2.0)
    retarget = Retarget(1.0)
    retarget.follow(hand(phone, clutch=True), REST)
    target = retarget.follow(hand(moved, clutch=True), REST)
    assert np.isfinite(target.pose_tool_in_base.position).all()
    assert np.linalg.norm(target.pose_tool_in_base.quaternion_wxyz) == pytest.approx(1.0)


def _right_of(phone_heading_rad: float) -> np.ndarray:
    return np.array([math.cos(phone_heading_rad), 0.0, -math.sin(phone_heading_rad)])
