"""An episode of somebody's own task carries its task file, also after a crash and where the file is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes.labelled_episode import describe
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import NotFound
from mart.protocol.messages import Model
from mart.protocol.tasks import get_task
from mart.recorder.repair.repair import repair_all
from mart.recorder.verify.stretches import own_task_of
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_part
from tests.support.drawer_demonstration import TASK_FILE

TEXT = TASK_FILE.read_bytes()


def repaired(folder: Path) -> EpisodeFile:
    (_done,) = repair_all(folder, by_toy_replica)
    (path,) = folder.rglob("*.mcap")
    return EpisodeFile.open(path)


@pytest.fixture
def left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which an episode of a task was being written whose file is elsewhere."""
    model = Model()
    model.CopyFrom(synthetic.MODEL)
    model.task, model.task_file = "two_arm_drawer", TEXT
    monkeypatch.setattr(synthetic, "MODEL", model)
    monkeypatch.setenv("MART_TASKS_DIR", str(tmp_path / "nothing"))
    file, _, _ = write_part(tmp_path, synthetic.states(12))
    file.flush()
    file.abandon()
    return tmp_path


def test_it_is_kept_by_a_repair_and_says_the_task(left: Path) -> None:
    file = repaired(left)
    assert file.task_file() == TEXT
    with pytest.raises(NotFound):
        get_task("two_arm_drawer")
    own = own_task_of(file, file.room.model_copy(update={"task": "two_arm_drawer"}))
    assert own is not None
    assert (own.task_file, own.mjb) == (TEXT, synthetic.MJB)


def test_an_episode_of_the_catalogue_carries_none(tmp_path: Path) -> None:
    file, _, _ = write_part(tmp_path, synthetic.states(12))
    file.flush()
    file.abandon()
    again = repaired(tmp_path)
    assert again.task_file() is None
    assert own_task_of(again, again.room) is None
    found = describe(again.path, again.path.name)
    assert found.recorded_task().name == synthetic.TASK
