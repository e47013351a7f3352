"""The app's messages become poses in the session frame of phone frames; what is no message is refused in words."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.protocol.pose import rotate
from mart.teleop_gateway.arkit.ar_message import LONGEST_MESSAGE_CHARS, parse_sample
from tests.teleop_gateway.arkit.ar_app import app_message, camera_at

ANGLES = st.floats(-1.4, 1.4)
PLACES = st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 5))


@given(place=PLACES, yaw_rad=ANGLES, pitch_rad=ANGLES)
def test_a_phone_is_where_arkit_says_right_up_and_towards_the_person(
    place: tuple[float, float, float], yaw_rad: float, pitch_rad: float
) -> None:
    sample = parse_sample(app_message(camera_at(place, yaw_rad, pitch_rad)))
    np.testing.assert_allclose(sample.pose_phone_in_session.position, place, atol=1e-9)
    turned = rotate(sample.pose_phone_in_session.quaternion_wxyz, np.array((1.0, 0.0, 0.0)))
    np.testing.assert_allclose(turned, (np.cos(yaw_rad), 0.0, -np.sin(yaw_rad)), atol=1e-9)


def test_a_phone_that_was_held_obliquely_at_the_start_moves_along_the_same_axes() -> None:
    began = camera_at((0, 0, 0), pitch_rad=-0.8)
    sample = parse_sample(app_message(camera_at((0.1, 0.2, -0.3), pitch_rad=-0.8), began=began))
    np.testing.assert_allclose(sample.pose_phone_in_session.position, (0.1, 0.2, -0.3), atol=1e-9)
    np.testing.assert_allclose(sample.pose_phone_in_session.quaternion_wxyz, (1, 0, 0, 0), atol=1e-9)


def test_buttons_are_read_and_what_newer_apps_send_besides_is_not() -> None:
    message = json.loads(app_message(camera_at((0, 0, 0)), button=True, toggle=True))
    message |= {"finger_angles": [0] * 5, "landmarks": [[0, 0, 0]] * 21}
    sample = parse_sample(json.dumps(message))
    assert (sample.button, sample.toggle) == (True, True)
    del message["button"], message["toggle"]
    sample = parse_sample(json.dumps(message))
    assert (sample.button, sample.toggle) == (False, False)


IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize(
    "message",
    [
        "",
        "{",
        "[" * 5000,
        "[]",
        {"rotation": IDENTITY},
        {"position": [0, 0, 0]},
        {"rotation": IDENTITY, "position": [0, 0]},
        {"rotation": IDENTITY, "position": [0, 0, "x"]},
        {"rotation": IDENTITY, "position": [0, 0, float("nan")]},
        {"rotation": IDENTITY, "position": [0, 0, 101]},
        {"rotation": IDENTITY, "position": [0, 0, 10**400]},
        {"rotation": [[2, 0, 0], [0, 1, 0], [0, 0, 1]], "position": [0, 0, 0]},
        {"rotation": [[-1, 0, 0], [0, 1, 0], [0, 0, 1]], "position": [0, 0, 0]},
        {"rotation": [[1, 0], [0, 1]], "position": [0, 0, 0]},
        " " * (LONGEST_MESSAGE_CHARS + 1),
    ],
    ids=lambda message: str(message)[:40],
)
def test_what_is_no_message_is_refused(message: str | dict[str, Any]) -> None:
    text = message if isinstance(message, str) else json.dumps(message)
    with pytest.raises(InvalidInput):
        parse_sample(text)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=12,
)


@given(rotation=JSON, position=JSON, button=JSON)
def test_no_message_does_more_than_be_refused(rotation: Any, position: Any, button: Any) -> None:
    try:
        sample = parse_sample(json.dumps({"rotation": rotation, "position": position, "button": button}))
    except InvalidInput:
        return
    assert np.isfinite(sample.pose_phone_in_session.position).all()


@given(st.binary(max_size=200) | st.text(max_size=200))
def test_no_bytes_do_more_than_be_refused(noise: bytes | str) -> None:
    with pytest.raises(InvalidInput):
        parse_sample(noise)
