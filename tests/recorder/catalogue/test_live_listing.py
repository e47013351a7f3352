"""Nobody waits for a folder that is read for long: what is known of it is answered meanwhile."""

from __future__ import annotations

import threading
from contextlib import closing
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.labelled_episode import LabelledEpisode, describe
from mart.episodes.labels import LabelKind
from mart.protocol.messages import CatalogueRequest
from mart.recorder.catalogue import episode_catalogue, live_listing
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.live_listing import LiveListing
from tests.recorder.files import write_episode

names_below = episode_catalogue._names_below


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


def test_how_far_a_rebuild_is_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in (1, 2, 3):
        write_episode(tmp_path, ticks=5, number=number)
    may_read, waits = threading.Event(), threading.Event()

    def slowly(file_path: Path, of: str) -> LabelledEpisode:
        if "0002" in of:
            waits.set()
            may_read.wait(30)
        return describe(file_path, of)

    monkeypatch.setattr(episode_catalogue, "describe", slowly)
    monkeypatch.setattr(episode_catalogue, "_AT_ONCE", 1)
    monkeypatch.setattr(episode_catalogue, "_names_below", lambda root: sorted(names_below(root)))
    monkeypatch.setattr(live_listing, "_FIRST_PATIENCE_S", 0.01)
    with closing(CatalogueHandlers(tmp_path)) as asked:
        asked.answer(CatalogueRequest(list=CatalogueRequest.List()))
        assert waits.wait(30)
        told = asked.answer(CatalogueRequest(list=CatalogueRequest.List())).listing
        assert (told.files_read, told.files_to_read, told.matching) == (1, 3, 1)
        may_read.set()
        monkeypatch.setattr(live_listing, "_PATIENCE_S", 30.0)
        told = asked.answer(CatalogueRequest(list=CatalogueRequest.List())).listing
        assert (told.files_read, told.files_to_read, told.matching) == (0, 0, 3)
