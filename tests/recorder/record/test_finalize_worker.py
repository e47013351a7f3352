"""The folder is tidied between files, never while one waits to be completed."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from pathlib import Path
from typing import cast

from mart.episodes.reader import EpisodeFile
from mart.protocol.messages import Model
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.finalize import SavedEpisode
from mart.recorder.record.finalize_worker import FinalizeWorker
from mart.recorder.record.room_models import RoomModels
from mart.runtime.bus.memory import MemoryNetwork
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_part


class KnownModels:
    """The model of every room is the toy's."""

    def fetch(self, _room: str, _boot: int) -> Model:
        return synthetic.MODEL


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

    announcer = Announcer(MemoryNetwork().connect(), tmp_path)
    worker = FinalizeWorker(tmp_path, cast("RoomModels", KnownModels()), announcer, verify, tidy)
    worker.finalize(*slow)
    worker.finalize(*quick)
    worker.tidy()  # comes when the quick one is done, and lets the slow one go on
    worker.close()
    assert tidied == [1, 2]
