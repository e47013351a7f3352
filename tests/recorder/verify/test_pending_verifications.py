"""A verification that could not be had is tried by itself until it is had, also after the recorder was started anew."""

from __future__ import annotations

import contextlib
import queue
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from mart.episodes.folder import list_episodes
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import Event
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import ServiceKind, Verdict
from mart.recorder.service import tidy, verifying_again
from mart.recorder.settings import RecorderSettings
from mart.recorder.verify import pending_verifications
from mart.recorder.verify.pending_verifications import PendingVerifications
from mart.recorder.verify.replica import nobody, replica
from mart.recorder.verify.resimulation import verify
from mart.recorder.verify.retry_schedule import RetrySchedule
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode

PATIENCE_S = 20.0


def by_nobody(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
    return verify(file, room, nobody(Unavailable("no router")))


def unverified(root: Path, number: int = 1) -> Path:
    """An episode that nobody could verify when it was saved."""
    path = write_episode(root, 5, number, by_nobody).path
    (listed,) = list_episodes(path)
    assert (listed.verdict, listed.verification_pending) == (Verdict.UNVERIFIED, True)
    return path


class Verdicts:
    """What was told, and a thread that tries."""

    def __init__(self) -> None:
        self.told: queue.Queue[tuple[Path, Verdict]] = queue.Queue()

    @contextlib.contextmanager
    def trying(
        self,
        verify_file: Callable[[EpisodeFile, RoomRecord], VerificationRecord],
        listed: list[LabelledEpisode],
        *,
        is_up: Callable[[], bool] = lambda: True,
    ) -> Iterator[PendingVerifications]:
        pending = PendingVerifications(
            verify_file,
            is_up,
            lambda saved: self.told.put((saved.path, saved.verification.verdict)),
            lambda: listed,
        )
        pending.see(listed)
        pending.start()
        with contextlib.closing(pending):
            yield pending


@pytest.fixture
def verdicts() -> Verdicts:
    return Verdicts()


def test_what_is_pending_in_a_folder_is_verified_and_labelled(tmp_path: Path, verdicts: Verdicts) -> None:
    paths = {unverified(tmp_path, number) for number in (1, 2)}
    done = write_episode(tmp_path, 5, 3).path
    with verdicts.trying(by_toy_replica, list_episodes(tmp_path)):
        told = dict(verdicts.told.get(timeout=PATIENCE_S) for _ in paths)
    assert told == dict.fromkeys(paths, Verdict.VERIFIED)
    listed = {one.file_path: (one.verified, one.verification_pending) for one in list_episodes(tmp_path)}
    assert listed == dict.fromkeys([*paths, done], (True, False))


def test_one_that_raises_or_is_gone_keeps_no_other_from_its_verdict(
    tmp_path: Path, verdicts: Verdicts
) -> None:
    gone, bad, good = (unverified(tmp_path, number) for number in (1, 2, 3))
    listed = list_episodes(tmp_path)
    gone.unlink()

    def raising(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
        if file.path == bad:
            raise ValueError("a fault")
        return by_toy_replica(file, room)

    with verdicts.trying(raising, listed):
        assert verdicts.told.get(timeout=PATIENCE_S) == (good, Verdict.VERIFIED)
    assert list_episodes(bad)[0].verification_pending


def test_more_than_are_held_at_once_all_come_by(
    tmp_path: Path, verdicts: Verdicts, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pending_verifications, "RetrySchedule", lambda: RetrySchedule(2))
    paths = {unverified(tmp_path, number) for number in (1, 2, 3, 4, 5)}

    class Relisted(list[LabelledEpisode]):
        """The folder as it is whenever somebody looks."""

        def __iter__(self) -> Iterator[LabelledEpisode]:
            return iter(list_episodes(tmp_path))

    with verdicts.trying(by_toy_replica, Relisted()):
        assert {verdicts.told.get(timeout=PATIENCE_S)[0] for _ in paths} == paths


def test_a_verdict_that_is_no_better_is_settled_and_not_asked_again(
    tmp_path: Path, verdicts: Verdicts
) -> None:
    path = unverified(tmp_path)

    def elsewhere(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
        return verify(file, room, synthetic.ToyReplica("cc", "dd", ("aa",)))

    with verdicts.trying(elsewhere, list_episodes(path)):
        assert verdicts.told.get(timeout=PATIENCE_S) == (path, Verdict.UNVERIFIED)
    assert not list_episodes(path)[0].verification_pending


def serve_toy_replica(bus: MemoryBus) -> None:
    bus.serve(
        keys.rollout("replica-1"), lambda request: request.reply(synthetic.rollout_reply(request.payload))
    )
    bus.announce(keys.alive(ServiceKind.REPLICA, "replica-1"))


def test_the_recorder_verifies_as_soon_as_a_replica_appears_and_tells_the_room(tmp_path: Path) -> None:
    path = unverified(tmp_path / "episodes")
    network = MemoryNetwork()
    bus, told = network.connect(), queue.Queue[Event]()
    bus.subscribe(
        keys.event(synthetic.ROOM).key, lambda sample: told.put(codec.decode(Event, sample.payload))
    )
    ask = replica(bus, "replica-1")

    def verify_file(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
        return verify(file, room, ask)

    settings = RecorderSettings(data_dir=tmp_path)
    with verifying_again(bus, settings, "recorder-1", verify_file) as pending:
        assert list(tidy(settings.episodes_dir, verify_file, {}, pending.see)) == []
        serve_toy_replica(network.connect())
        event = told.get(timeout=PATIENCE_S).episode_saved
    assert (event.number, event.verified, event.verdict) == (1, True, "verified")
    assert event.path == path.relative_to(tmp_path).as_posix()
    assert list_episodes(path)[0].verified
