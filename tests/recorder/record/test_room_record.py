"""What a file says of its room may grow while it is written, and never contradicts itself."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol.errors import Corrupt
from mart.protocol.recording import RoomRecord
from tests.recorder import synthetic


@pytest.mark.parametrize(("later_task", "reads"), [(synthetic.TASK, True), ("three_arm_lift_wiping", False)])
def test_a_later_record_may_know_more(tmp_path: Path, later_task: str, reads: bool) -> None:
    file = EpisodeWriter(tmp_path / "a.mcap.part")
    file.describe(RoomRecord(room="room-1", task=synthetic.TASK))
    file.describe(RoomRecord(room="room-1", task=later_task, mujoco_version="4.0.0"))
    file.finish()
    if reads:
        assert EpisodeFile.open(file.path).room.mujoco_version == "4.0.0"
    else:
        with pytest.raises(Corrupt):
            EpisodeFile.open(file.path)
    file.abandon()
