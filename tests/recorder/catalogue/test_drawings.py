"""Episodes without video are drawn from their states: lockstep ones, also those of version 0.1.0."""

from __future__ import annotations

import tarfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from mart.protocol import clock
from mart.protocol.errors import NotFound
from mart.protocol.messages import CatalogueReply, CatalogueRequest
from mart.recorder.catalogue.handlers import PIECE_BYTES, CatalogueHandlers

ARCHIVE = Path("tests/fixtures/episodes_0_1_0/episodes.tar.xz")
PATH = "2026-11-29/lockstep.mcap"
WAIT_S = 60.0
JPEG, MP4 = b"\xff\xd8", b"ftyp"


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("episodes")
    with tarfile.open(ARCHIVE) as archive:
        archive.extract(next(one for one in archive if one.name.endswith(PATH)), root, filter="data")
    return root


@pytest.fixture
def asked(root: Path, tmp_path: Path) -> Iterator[CatalogueHandlers]:
    with closing(CatalogueHandlers(root, tmp_path / "render.log")) as handlers:
        yield handlers


def video(asked: CatalogueHandlers, viewpoint: str) -> CatalogueReply.Piece:
    return asked.answer(CatalogueRequest(video=CatalogueRequest.Video(path=PATH, camera=viewpoint))).piece


def test_its_time_is_simulated_and_it_says_from_where_it_can_be_drawn(asked: CatalogueHandlers) -> None:
    details = asked.answer(CatalogueRequest(show=CatalogueRequest.Show(path=PATH))).details
    assert details.simulated
    assert details.wall_s == pytest.approx(66 / 20)
    assert (list(details.viewpoints), list(details.views)) == (["front", "arm0", "arm1"], [])
    assert max(span.end_s for lane in details.lanes for span in lane.spans) == pytest.approx(details.wall_s)


def test_its_last_state_is_its_thumbnail(asked: CatalogueHandlers) -> None:
    reply = asked.answer(CatalogueRequest(picture=CatalogueRequest.Picture(path=PATH)))
    assert reply.piece.piece.startswith(JPEG)


def test_only_viewpoints_are_drawn_from(asked: CatalogueHandlers) -> None:
    for viewpoint in ("--help", "arm7", ""):
        with pytest.raises(NotFound):
            video(asked, viewpoint)


@pytest.mark.system
def test_a_video_is_drawn_beside_and_had_when_it_is_ready(asked: CatalogueHandlers) -> None:
    assert video(asked, "front").pending
    until_s = clock.monotonic_s() + WAIT_S
    while (piece := video(asked, "front")).pending:
        assert clock.monotonic_s() < until_s
        clock.sleep_s(0.1)  # asking is how one is told
    assert MP4 in piece.piece[:16]
    assert len(piece.piece) == min(piece.size_bytes, PIECE_BYTES)
