"""An episode's scene is had as a seat's is, by its digest; its motion comes whole from pieces."""

from __future__ import annotations

import contextlib
import hashlib
import tarfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue import episode_scenes
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.serve import catalogue_answerer
from mart.runtime.bus.memory import MemoryBus
from mart.web.api.app_state import AppState
from tests.web.conftest import Enter

pytestmark = pytest.mark.anyio

ARCHIVE = Path("tests/fixtures/episodes_0_1_0/episodes.tar.xz")
PATH = "2026-11-29/lockstep.mcap"


@pytest.fixture
def catalogue(
    app_state: AppState, bus: MemoryBus, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[None]:
    """A catalogue that tells of one episode with a model, in small pieces."""
    monkeypatch.setattr(episode_scenes, "PIECE_BYTES", 10_000)
    with tarfile.open(ARCHIVE) as archive:
        archive.extract(next(one for one in archive if one.name.endswith(PATH)), tmp_path, filter="data")
    answerer = catalogue_answerer(CatalogueHandlers(tmp_path))
    with (
        contextlib.closing(bus.serve(keys.catalogue("catalogue-1"), answerer.respond)),
        contextlib.closing(bus.announce(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"))),
    ):
        yield


@pytest.mark.usefixtures("catalogue")
async def test_what_draws_an_episode_is_had(enter: Enter) -> None:
    ana = await enter("Ana")
    for _ in range(2):  # the second time it is known here
        sha256 = (await ana.get("/api/episode/scene", params={"path": PATH})).json()["sha256"]
        scene = await ana.get(f"/api/scenes/{sha256}")
        assert hashlib.sha256(scene.content).hexdigest() == sha256
        assert "immutable" in scene.headers["Cache-Control"]
    motion = await ana.get("/api/episode/motion", params={"path": PATH, "simulated": True})
    assert motion.content.startswith(b"MMO1")
    assert len(motion.content) == int(motion.headers["Content-Length"]) > 10_000
    unknown = await ana.get("/api/episode/motion", params={"path": "none.mcap"})
    assert unknown.status_code == 404
