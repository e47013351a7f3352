"""Run `mart recorder`: bus, inbox, recorder, replica, repair and catalogue, put together."""

from __future__ import annotations

import logging
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import MartError
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.episode_catalogue import list_folder
from mart.recorder.record.finalize import SavedEpisode, VerifyFile
from mart.recorder.record.inbox import Inbox, RoomSubscriptions
from mart.recorder.record.recorder import Recorder
from mart.recorder.repair.repair import log_repairs, repair_all
from mart.recorder.settings import RecorderSettings
from mart.recorder.verify.resimulation import replica, verify
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.service import announced, connected

_log = logging.getLogger(__name__)


def serve_recorder(settings: RecorderSettings, name: str) -> None:
    """Record until the process is asked to stop; what is being recorded then is saved as it is."""
    inbox = Inbox()
    with (
        connected(settings, ServiceKind.RECORDER, name) as service,
        ZenohBus.connect(settings.router) as video_bus,
    ):
        ask = replica(service.bus, settings.replica)

        def verify_file(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
            return verify(file, room, ask)

        root = settings.episodes_dir.resolve()
        told: dict[Path, str] = {}
        recorder = Recorder(
            settings.data_dir, service.bus, inbox, verify_file, lambda: tidy(root, verify_file, told)
        )
        with closing(RoomSubscriptions(service.bus, video_bus, inbox)), announced(service):
            recorder.run(service.stop)


def tidy(root: Path, verify_file: VerifyFile, told: dict[Path, str]) -> Iterator[SavedEpisode]:
    """Repair what crashes have left under `root`, yielding what became an episode; then refresh the catalogue.

    told: what was said of files that cannot be repaired, so that it is said once.
    """
    yield from log_repairs(repair_all(root, verify_file), told)
    try:
        list_folder(root)
    except (OSError, sqlite3.Error, MartError) as error:  # it is derived: the next one makes up for it
        _log.warning("The catalogue could not be brought up to date: %s", error)
