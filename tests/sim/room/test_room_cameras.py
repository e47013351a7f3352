"""A room says of each camera how it does, tells people when that changes, and waits for none."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import CameraReport
from mart.sim.room.room_cameras import SILENT_AFTER_S, RoomCameras

CAMERAS = ("arm0", "arm0-wrist", "table")


def told(cameras: RoomCameras, now_s: float) -> list[str]:
    return [event.notice.text for event in cameras.news(now_s)]


def dark(cameras: RoomCameras, now_s: float) -> dict[str, str]:
    return {one.camera: one.dark for one in cameras.messages(now_s) if one.dark}


def test_a_camera_that_never_came_is_named() -> None:
    cameras = RoomCameras(CAMERAS, 10.0)
    assert dark(cameras, 10.0 + SILENT_AFTER_S) == {}
    assert set(dark(cameras, 10.1 + SILENT_AFTER_S)) == set(CAMERAS)


def test_people_are_told_once_that_one_went_dark_and_once_that_it_is_back() -> None:
    cameras = RoomCameras(("arm0-wrist",), 0.0)
    cameras.hear(CameraReport(camera="arm0-wrist", frames_per_s=30.0), 1.0)
    assert told(cameras, 1.0) == []
    cameras.hear(CameraReport(camera="arm0-wrist", dark="Its picture is black.", dark_s=2.0), 2.0)
    assert told(cameras, 2.0) == ["The camera wrist of arm0 gives no picture. Its picture is black."]
    assert told(cameras, 2.2) == []
    cameras.hear(CameraReport(camera="arm0-wrist"), 2.5)
    assert told(cameras, 2.5) == ["The camera wrist of arm0 gives pictures again."]
    cameras.gone("arm0-wrist", 2.6)
    assert told(cameras, 2.6) == ["The camera wrist of arm0 gives no picture. Nothing captures it."]


@given(
    said=st.lists(
        st.builds(
            CameraReport,
            camera=st.sampled_from([*CAMERAS, "other", ""]),
            dark=st.sampled_from(["", "Its picture is black."]),
            dark_s=st.floats(),
        ),
        max_size=20,
    ),
    step_s=st.floats(0.0, 3.0),
)
def test_whatever_cameras_say_the_room_has_those_it_was_opened_with(
    said: list[CameraReport], step_s: float
) -> None:
    cameras = RoomCameras(CAMERAS, 0.0)
    for number, report in enumerate(said):
        cameras.hear(report, number * step_s)
        messages = cameras.messages(number * step_s)
        assert tuple(one.camera for one in messages) == CAMERAS
        assert all(0.0 <= one.dark_s <= 1e9 for one in messages)
