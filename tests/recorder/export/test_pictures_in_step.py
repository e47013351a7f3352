"""The picture of row k shows state k, over a whole minute: decoded, and fresh drawings beside it."""

from __future__ import annotations

import math
from pathlib import Path

import av
import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray

from mart.episodes.reader import open_episode
from mart.protocol.messages import State
from mart.protocol.pose import Pose
from mart.sim.world import World
from tests.recorder.export.test_pictures import drawn, write
from tests.trainer import recorded

SIDE_PX = 96
CAMERA = ("--camera", f"front:{SIDE_PX}x{SIDE_PX}")
FEATURE = "observation.images.front"
FAST_TICKS, MINUTE_TICKS = 40, 1200  # at 20 Hz

Pictures = NDArray[np.float64]  # shape (rows, height, width, 3)


def swinging(world: World, ticks: int) -> list[State]:
    """Both arms swing without end, so that no two pictures in a row are alike."""
    world.reset(1)
    begin = {arm: world.tool_pose_in_base(arm) for arm in world.arms}
    states = [recorded.state_of(world, 1, 0, None)]
    for tick in range(1, ticks + 1):
        shift_m = 0.1 * np.array([math.sin(tick / 5), math.sin(tick / 7), 0.5 + 0.5 * math.sin(tick / 9)])
        targets = {arm: Pose(at.position + shift_m, at.quaternion_wxyz) for arm, at in begin.items()}
        actions = [world.action_for(arm, target, 0.0) for arm, target in targets.items()]
        world.step(actions)
        states.append(recorded.state_of(world, 1, tick, np.array(actions)))
    return states


def decoded(path: Path) -> Pictures:
    """Read a video as LeRobot does, with FFmpeg; OpenCV brings another one, and both in a process have crashed."""
    with av.open(str(path)) as video:
        return np.array([frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)], np.float64)


def nearest(seen: Pictures, states: Pictures) -> list[int]:
    """Return for each picture which of the three states around its row it is most like: -1, 0 or 1 rows away.

    seen: of T rows. states: drawn of T + 1 states. The first row has none before it.
    """
    found = []
    for row, picture in enumerate(seen):
        around = [shift for shift in (-1, 0, 1) if row + shift >= 0]
        errors = [float(np.square(picture - states[row + shift]).mean()) for shift in around]
        found.append(around[int(np.argmin(errors))])
    return found


@pytest.mark.parametrize(
    "ticks", [FAST_TICKS, pytest.param(MINUTE_TICKS, marks=pytest.mark.slow, id="a_minute")]
)
def test_every_picture_is_of_the_state_of_its_row(tmp_path: Path, ticks: int) -> None:
    world = World.build(recorded.TASK)
    path = recorded.write(tmp_path / "episodes", world, swinging(world, ticks), with_model=True)
    states = np.array(drawn(path, "front", SIDE_PX, SIDE_PX), np.float64)
    write(tmp_path / "episodes", tmp_path / "data_set", "lerobot", *CAMERA)
    write(tmp_path / "episodes", tmp_path / "data_set.hdf5", "robomimic", *CAMERA)
    video = decoded(tmp_path / f"data_set/videos/{FEATURE}/chunk-000/file-000.mp4")
    rows = pq.read_table(tmp_path / "data_set/data/chunk-000/file-000.parquet")
    assert rows["recorded_tick"].to_pylist() == list(range(ticks))
    assert nearest(video, states) == [0] * ticks
    assert set(nearest(video[:-1], states[1:])[1:]) == {-1}  # a video that is one row late would be noticed
    with h5py.File(tmp_path / "data_set.hdf5") as file:
        np.testing.assert_array_equal(file["data/demo_0/obs/front_image"][:], states[:-1])
        np.testing.assert_array_equal(file["data/demo_0/next_obs/front_image"][:], states[1:])
    np.testing.assert_array_equal(open_episode(path).arrays().ticks[:-1], rows["recorded_tick"].to_numpy())
