"""The folder is tidied between files, never while one waits to be completed."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from pathlib import Path
from typing import cast

import pytest

from mart.episodes.reader import EpisodeFile
from mart.protocol import keys
from mart.protocol.messages import Event, Model
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.finalize import SavedEpisode, below, free_path
from mart.recorder.record.finalize_worker import FinalizeWorker
from mart.recorder.record.room_models import RoomModels
from mart.recorder.repair.repair import repair_all
from mart.runtime.bus.memory import MemoryNetwork
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_part


class KnownModels:
    """The model of every room is the toy's."""

    def known(self, _room: str, _boot: int) -> Model:
        return synthetic.MODEL

    fetch = known


def test_the_folder_is_tidied_once_no_file_waits(tmp_path: Path) -> None:
    slow, quick = (write_part(tmp_path, synthetic.states(3, number=number)) for number in (1, 2))
    slow_path = slow[0].path
    tidied: list[int] = []  # how many episodes were there
    was_tidied = threading.Event()

    def verify(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
        if file.path == slow_path:
            was_tidied.wait(30.0)
        return by_toy_replica(file, room)

    def tidy() -> Iterable[SavedEpisode]:
        tidied.append(len(list(tmp_path.rglob("*.mcap"))))
        was_tidied.set()
        return ()

    announcer = Announcer(MemoryNetwork().connect(), tmp_path, "recorder-1")
    worker = FinalizeWorker(tmp_path, cast("RoomModels", KnownModels()), announcer, verify, tidy)
    worker.finalize(*slow)
    worker.finalize(*quick)
    worker.tidy()  # comes when the quick one is done, and lets the slow one go on
    worker.close()
    assert tidied == [1, 2]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), ValueError("odd"), KeyError("x")])
def test_whatever_goes_wrong_is_told_and_the_file_is_let_go(tmp_path: Path, error: Exception) -> None:
    def verify(_file: EpisodeFile, _room: RoomRecord) -> VerificationRecord:
        raise error

    bus, told = MemoryNetwork().connect(), list[Event]()
    bus.subscribe(keys.EVERY_EVENT, lambda sample: told.append(Event.FromString(sample.payload)))
    announcer = Announcer(bus, tmp_path, "recorder-1")
    worker = FinalizeWorker(tmp_path, cast("RoomModels", KnownModels()), announcer, verify, lambda: ())
    part = write_part(tmp_path, synthetic.states(3))
    worker.finalize(*part)
    worker.close()
    (event,) = told
    assert (event.notice.level, str(part[0].path) in event.notice.text) == ("error", True)
    (repaired,) = repair_all(tmp_path, by_toy_replica)  # it is no longer locked
    assert repaired.saved is not None


def test_no_file_is_ever_overwritten(tmp_path: Path) -> None:
    file, episode, facts = write_part(tmp_path, synthetic.states(3))
    name = free_path(tmp_path, episode.record(facts))
    file.finish()
    name.write_bytes(b"of somebody who was quicker")
    with pytest.raises(FileExistsError):
        file.move_to(name)
    below(tmp_path)(file, episode.record(facts))
    assert file.path.name.endswith("-2.mcap")
    assert name.read_bytes() == b"of somebody who was quicker"
