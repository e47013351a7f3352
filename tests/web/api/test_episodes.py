"""Recorded episodes over HTTP; behind them a real catalogue's answers to real files."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.protocol import codec, keys
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_RECORDING,
    CatalogueReply,
    CatalogueRequest,
    RoomStatus,
)
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue import handlers
from mart.recorder.catalogue.episode_catalogue import list_folder
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.quality_measurer import QualityMeasurer
from mart.recorder.catalogue.serve import catalogue_answerer
from mart.runtime.bus.memory import MemoryBus
from mart.web.api.app_state import AppState
from mart.web.clients.missed_saves import MissedSaves
from tests.recorder import synthetic
from tests.recorder.files import write_episode
from tests.web.conftest import Enter

pytestmark = pytest.mark.anyio

PATH = f"2026-09-21/room-1-0001-{synthetic.TASK}.mcap"


@pytest.fixture
def root(app_state: AppState, bus: MemoryBus, tmp_path: Path) -> Iterator[Path]:
    """A folder with two episodes, and a catalogue that tells of it."""
    for number in (1, 2):
        write_episode(tmp_path, ticks=30, number=number)
    quality = QualityMeasurer()
    quality.see(list_folder(tmp_path))
    quality.measure_wanted()
    answerer = catalogue_answerer(CatalogueHandlers(tmp_path, quality=quality))
    with (
        contextlib.closing(bus.serve(keys.catalogue("catalogue-1"), answerer.respond)),
        contextlib.closing(bus.announce(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"))),
    ):
        yield tmp_path


async def test_without_a_catalogue_the_page_waits(enter: Enter) -> None:
    ana = await enter("Ana")
    assert (await ana.get("/api/episodes")).json() == {"listing": None}
    refused = await ana.get("/api/episode", params={"path": PATH})
    assert refused.status_code == 503
    assert "`mart catalogue`" in refused.json()["error"]["message"]


@pytest.mark.parametrize(
    "path",
    [
        "episodes",
        "episodes/quality",
        "episode",
        "episode/file",
        "episode/picture",
        "episode/quality",
        "episode/video",
        "episode/scene",
        "episode/motion",
    ],
)
async def test_only_who_has_joined_sees_episodes(enter: Enter, root: Path, path: str) -> None:
    asked = await (await enter()).get(f"/api/{path}", params={"path": PATH, "camera": "arm0"})
    assert asked.status_code == 401


async def test_a_page_of_the_list(enter: Enter, root: Path) -> None:
    await asyncio.sleep(0)
    listing = (await (await enter("Ana")).get("/api/episodes", params={"count": 1})).json()["listing"]
    assert (listing["matching"], listing["successes"]) == (2, 2)
    assert listing["tasks"] == {synthetic.TASK: "Multi-cube lifting"}
    (episode,) = listing["episodes"]
    assert (episode["number"], episode["title"]) == (2, "Multi-cube lifting")
    assert episode["started_ms"] == pytest.approx(synthetic.START_NS / 1e6, abs=10)
    assert episode["real_time_factor"] == pytest.approx(1.0)


@pytest.mark.parametrize("asked", [{"count": 0}, {"count": 201}, {"offset": -1}, {"task": "x" * 129}])
async def test_a_list_is_bounded(enter: Enter, root: Path, asked: dict[str, object]) -> None:
    refused = await (await enter("Ana")).get("/api/episodes", params={k: str(v) for k, v in asked.items()})
    assert (refused.status_code, refused.json()["error"]["code"]) == (400, "InvalidInput")


async def test_one_in_detail(enter: Enter, root: Path) -> None:
    await asyncio.sleep(0)
    details = (await (await enter("Ana")).get("/api/episode", params={"path": PATH})).json()["details"]
    assert details["episode"]["operators"] == {"arm0": "human Ana", "arm1": "hold"}
    assert details["views"] == [{"camera": "arm0", "start_s": 0.0}]
    assert {lane["kind"] for lane in details["lanes"]} >= {"driver"}


async def test_it_is_labelled_by_this_sites_pages_only(enter: Enter, root: Path) -> None:
    ana = await enter("Ana")
    said = {"outcome": "failure", "note": "too late"}
    foreign = await ana.post(
        "/api/episode", params={"path": PATH}, json=said, headers={"Origin": "https://evil.example"}
    )
    assert foreign.status_code == 403
    told = (await ana.post("/api/episode", params={"path": PATH}, json=said)).json()["episode"]
    assert (told["outcome"], told["note"], told["dropped"]) == ("failure", "too late", False)
    for bad in ({"outcome": "great"}, {"note": "x" * 2001}, {}):
        assert (await ana.post("/api/episode", params={"path": PATH}, json=bad)).status_code == 400


async def test_a_data_set_is_put_together_and_every_act_is_undone(enter: Enter, root: Path) -> None:
    ana = await enter("Ana")
    body = {"action": "add", "paths": [PATH]}
    foreign = await ana.post("/api/datasets/good", json=body, headers={"Origin": "https://evil.example"})
    assert foreign.status_code == 403
    curated = (await ana.post("/api/datasets/good", json=body)).json()["curated"]
    assert (curated["changed"], curated["episodes"], curated["left_out"]) == (1, 1, {})
    everything = {"action": "add", "all": {"task": synthetic.TASK}}
    assert (await ana.post("/api/datasets/good", json=everything)).json()["curated"]["episodes"] == 2
    await ana.post("/api/datasets/good", json={"action": "remove", "paths": [PATH]})
    listing = (await ana.get("/api/episodes", params={"dataset": "good"})).json()["listing"]
    assert (listing["matching"], [one["name"] for one in listing["datasets"]]) == (1, ["good"])
    undone = await ana.post("/api/datasets/good/undo", json={"act_ns": curated["act_ns"]})
    assert undone.json()["curated"]["episodes"] == 1
    assert {label.by for label in labels.read(root)} == {"Ana"}


@pytest.mark.parametrize(
    ("dataset", "body", "status"),
    [
        ("good", {"action": "add"}, 400),
        ("good", {"action": "burn", "paths": [PATH]}, 400),
        ("good", {"action": "add", "paths": [PATH] * 201}, 400),
        ("good", {"action": "add", "paths": [PATH], "all": {}}, 400),
        ("Good data", {"action": "add", "paths": [PATH]}, 400),
        ("good", {"action": "remove", "paths": [PATH]}, 404),
        ("good", {"action": "add", "paths": ["../join-code"]}, 404),
    ],
)
async def test_what_cannot_be_put_together_is_said(
    enter: Enter, root: Path, dataset: str, body: dict[str, object], status: int
) -> None:
    refused = await (await enter("Ana")).post(f"/api/datasets/{dataset}", json=body)
    assert (refused.status_code, bool(refused.json()["error"]["message"])) == (status, True)


async def test_the_file_is_downloaded_whole(
    enter: Enter, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(handlers, "PIECE_BYTES", 1000)
    await asyncio.sleep(0)
    answer = await (await enter("Ana")).get("/api/episode/file", params={"path": PATH})
    assert answer.content == (root / PATH).read_bytes()
    assert answer.headers["content-disposition"] == f'attachment; filename="{Path(PATH).name}"'


async def test_no_path_leads_out_of_the_episodes(enter: Enter, root: Path) -> None:
    ana = await enter("Ana")
    for path in ("../join-code", "/etc/passwd", "labels.jsonl", ""):
        refused = await ana.get("/api/episode/file", params={"path": path})
        assert (refused.status_code, refused.json()["error"]["code"]) == (404, "NotFound")


async def test_where_no_picture_can_be_shown_there_is_none(enter: Enter, root: Path) -> None:
    await asyncio.sleep(0)
    answer = await (await enter("Ana")).get("/api/episode/picture", params={"path": PATH})
    assert (answer.status_code, answer.content) == (204, b"")


def test_garbage_is_answered_with_a_sentence(tmp_path: Path) -> None:
    answerer = catalogue_answerer(CatalogueHandlers(tmp_path))
    assert codec.decode(CatalogueReply, answerer(b"\xff\xff\xff")).error.code == "InvalidInput"
    empty = codec.decode(CatalogueReply, answerer(codec.encode(CatalogueRequest())))
    assert empty.error.message.startswith("An empty")


async def test_what_is_saved_without_a_word_is_found_in_the_catalogue(
    app_state: AppState, root: Path
) -> None:
    await asyncio.sleep(0)
    lobby = app_state.lobby
    status = RoomStatus(
        room="room-1", task=synthetic.TASK, barrier=BARRIER_PHASE_RUNNING, wall_ns=synthetic.START_NS
    )
    status.episode.number = 1
    lobby.see_alive(keys.alive(ServiceKind.SIM, "room-1"), True)
    for status.episode.phase in (EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED):
        lobby.see_status(status, 0.0)
    with lobby.listeners.listen() as page:
        await MissedSaves(lobby, app_state.catalogue).ask(now_s=60.0)
        (event,) = page.take_events()
    assert (event["kind"], event["path"], event["verdict"]) == (
        "episode_saved",
        f"episodes/{PATH}",
        "verified",
    )


async def test_how_well_an_episode_was_is_told(enter: Enter, root: Path) -> None:
    quality = (await (await enter("Ana")).get("/api/episode/quality", params={"path": PATH})).json()[
        "quality"
    ]
    assert (quality["pending"], quality["error"], quality["episodes"]) == (False, "", 0)
    assert {
        "name": "duration_s",
        "arm": "",
        "title": "Length",
        "unit": "s",
        "value": 1.5,
        "outlier": "",
    } in quality["numbers"]


async def test_people_and_days_are_compared(enter: Enter, root: Path) -> None:
    ana, asked = await enter("Ana"), {"task": synthetic.TASK}
    found = (await ana.get("/api/episodes/quality", params=asked)).json()["comparison"]
    assert [group["name"] for group in found["groups"]] == ["Ana", "hold"]
    assert (found["measured"], found["episodes"], found["outliers"]) == (2, 2, [])
    found = (await ana.get("/api/episodes/quality", params=asked | {"by": "day"})).json()["comparison"]
    assert [group["name"] for group in found["groups"]] == ["2026-09-21"]
    assert (await ana.get("/api/episodes/quality", params=asked | {"by": "shoe size"})).status_code == 400
    assert (await ana.get("/api/episodes", params={"outliers": "true"})).json()["listing"]["episodes"] == []


async def test_it_is_edited_by_name_and_taken_back(enter: Enter, root: Path) -> None:
    ana = await enter("Ana")
    asked = {"path": PATH}
    said = {"edits": [{"kind": "cut", "value": "0-5"}, {"kind": "split", "value": "20"}]}
    edited = (await ana.post("/api/episode/edits", params=asked, json=said)).json()["edited"]
    assert edited["episode"]["kept_ticks"] == 25
    assert edited["edits"]["acts"][0]["by"] == "Ana"
    assert (await ana.get("/api/episode/edits", params=asked)).json()["edited"]["edits"] == edited["edits"]
    undone = await ana.post("/api/episode/edits/undo", params=asked, json={"act_ns": edited["act_ns"]})
    assert undone.json()["edited"]["edits"]["acts"] == []
    for bad in ({"edits": [{"kind": "cut", "value": "0-99"}]}, {"edits": [{"kind": "use", "value": "drop"}]}):
        assert (await ana.post("/api/episode/edits", params=asked, json=bad)).status_code == 400
