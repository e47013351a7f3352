"""Run `mart recorder`: bus, inbox, recorder, replica, repair and catalogue, put together."""

from __future__ import annotations

import logging
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol import keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.episode_catalogue import list_folder
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.finalize import SavedEpisode, VerifyFile
from mart.recorder.record.inbox import Inbox, RoomSubscriptions
from mart.recorder.record.recorder import Recorder
from mart.recorder.repair.repair import log_repairs, repair_all
from mart.recorder.settings import RecorderSettings
from mart.recorder.verify.pending_verifications import PendingVerifications
from mart.recorder.verify.replica import replica
from mart.recorder.verify.resimulation import verify
from mart.runtime.bus import Bus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.live_services import LiveIds
from mart.runtime.service import announced, connected

_FORGOTTEN_AFTER_S = 10.0  # a router that is started anew forgets every token for about 2 s

_log = logging.getLogger(__name__)


def serve_recorder(settings: RecorderSettings, name: str) -> None:
    """Record until the process is asked to stop; what is being recorded then is saved as it is."""
    inbox, root = Inbox(), settings.episodes_dir.resolve()
    with (
        connected(settings, ServiceKind.RECORDER, name) as service,
        ZenohBus.connect(settings.router) as video_bus,
        closing(LiveIds(service.bus, ServiceKind.SIM, _FORGOTTEN_AFTER_S)) as live_rooms,
    ):
        ask = replica(service.bus, settings.replica)

        def verify_file(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
            return verify(file, room, ask)

        told: dict[Path, str] = {}
        with verifying_again(service.bus, settings, name, verify_file) as pending:

            def tidy_folder() -> Iterator[SavedEpisode]:
                return tidy(root, verify_file, told, pending.see)

            recorder = Recorder(
                settings.data_dir,
                service.bus,
                inbox,
                live_rooms=live_rooms,
                verify=verify_file,
                tidy=tidy_folder,
                name=name,
            )
            with closing(RoomSubscriptions(service.bus, video_bus, inbox)), announced(service):
                recorder.run(service.stop)


@contextmanager
def verifying_again(
    bus: Bus, settings: RecorderSettings, name: str, verify_file: VerifyFile
) -> Iterator[PendingVerifications]:
    """Try pending verifications while the block runs, at once when the replica appears. name: of the recorder."""
    root = settings.episodes_dir.resolve()
    token = keys.alive(ServiceKind.REPLICA, settings.replica)
    announcer = Announcer(bus, settings.data_dir.resolve(), name)

    def is_up() -> bool:
        try:
            return bool(bus.alive(token))
        except Unavailable:  # the router is away
            return False

    def on_token(_key: str, alive: bool) -> None:
        if alive:
            pending.wake()

    pending = PendingVerifications(verify_file, is_up, announcer.saved, lambda: list_folder(root))
    pending.start()
    with closing(pending), closing(bus.watch(token, on_token)):
        yield pending


def tidy(
    root: Path,
    verify_file: VerifyFile,
    told: dict[Path, str],
    on_listed: Callable[[Iterable[LabelledEpisode]], None] | None = None,
) -> Iterator[SavedEpisode]:
    """Repair what crashes have left under `root`, yielding what became an episode; then refresh the catalogue.

    told: what was said of files that cannot be repaired, so that it is said once.
    on_listed: is told of every episode that is there then.
    """
    yield from log_repairs(repair_all(root, verify_file), told)
    try:
        listed = list_folder(root)
        if on_listed is not None:
            on_listed(listed)
    except (OSError, sqlite3.Error, MartError) as error:  # it is derived: the next one makes up for it
        _log.warning("The catalogue could not be brought up to date: %s", error)
