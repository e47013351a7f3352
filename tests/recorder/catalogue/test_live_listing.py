"""Nobody waits for a folder that is read for long: what is known of it is answered meanwhile."""

from __future__ import annotations

import threading
from contextlib import closing
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.labelled_episode import LabelledEpisode, describe
from mart.episodes.labels import LabelKind
from mart.recorder.catalogue import episode_catalogue, live_listing
from mart.recorder.catalogue.live_listing import LiveListing
from tests.recorder.files import write_episode


def test_known_rows_are_answered_while_the_catalogue_is_rebuilt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_episode(tmp_path, ticks=5).path
    with closing(LiveListing(tmp_path)) as listing:
        (name,) = listing.rows()
        may_read = threading.Event()

        def slowly(file_path: Path, of: str) -> LabelledEpisode:
            may_read.wait(30)
            return describe(file_path, of)

        monkeypatch.setattr(episode_catalogue, "describe", slowly)
        monkeypatch.setattr(live_listing, "_FIRST_PATIENCE_S", 0.01)
        (tmp_path / episode_catalogue.FILE_NAME).unlink()
        labels.say(path, LabelKind.NOTE, "said meanwhile", at_ns=1)
        assert listing.rows(anew=True)[name].note == "said meanwhile"
        may_read.set()
        monkeypatch.setattr(live_listing, "_FIRST_PATIENCE_S", 30.0)
        assert list(listing.rows(anew=True)) == [name]


def test_a_line_deleted_by_hand_takes_back_what_it_said(tmp_path: Path) -> None:
    path = write_episode(tmp_path, ticks=5).path
    labels.say(path, LabelKind.NOTE, "wrong", at_ns=1)
    with closing(LiveListing(tmp_path)) as listing:
        (row,) = listing.rows().values()
        assert row.note == "wrong"
        (tmp_path / labels.FILE_NAME).write_bytes(b"")
        (row,) = listing.rows().values()
        assert row.note is None
