from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mart.episodes import labels
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.mcap_entries import video_entry
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import CatalogueReply, CatalogueRequest
from mart.recorder.catalogue import handlers
from mart.recorder.catalogue.dataset_editing import take_in
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.record.finalize import finalize
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part
from tests.recorder.importing import sources

PATH = f"2026-09-21/room-1-0001-{synthetic.TASK}.mcap"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    write_episode(tmp_path, ticks=30, number=1)
    return tmp_path


def show(answers: CatalogueHandlers) -> CatalogueReply.Details:
    return answers.answer(CatalogueRequest(show=CatalogueRequest.Show(path=PATH))).details


def listed(answers: CatalogueHandlers) -> list[str]:
    listing = answers.answer(CatalogueRequest(list=CatalogueRequest.List())).listing
    return [episode.path for episode in listing.episodes]


def test_an_episode_is_listed_and_shown(root: Path) -> None:
    asked = CatalogueHandlers(root)
    assert listed(asked) == [PATH]
    details = show(asked)
    assert (details.episode.path, details.episode.ticks) == (PATH, 30)
    assert details.wall_s == pytest.approx(1.5)
    assert [(view.camera, view.start_s) for view in details.views] == [("arm0", 0.0)]
    assert details.cadence["missing_ticks"] == "0"
    assert details.verification


def test_what_real_cameras_captured_is_among_the_views(tmp_path: Path) -> None:
    file, episode, facts = write_part(tmp_path, synthetic.states(30))
    assert episode.started is not None
    episode.started.captured_cameras.extend(["arm0", "arm0-wrist", "arm1-wrist", "table"])
    video = synthetic.video(6, is_key=True)
    file.add(video_entry("arm0-wrist", video, codec.encode(video), synthetic.wall_ns(4)))
    astray = synthetic.video(6, is_key=True)
    astray.timestamp.seconds += 120  # by the clock of its machine
    file.add(video_entry("arm1-wrist", astray, codec.encode(astray), synthetic.wall_ns(4)))
    finalize(file, episode, facts, tmp_path, by_toy_replica, repaired=False)
    views = {view.camera: view.start_s for view in show(CatalogueHandlers(tmp_path)).views}
    assert views == {
        "arm0": 0.0,
        "arm0-wrist": pytest.approx(0.198),
        "arm1-wrist": pytest.approx(0.2),
    }  # none of the table's came


def test_what_was_imported_without_arms_and_pictures_is_shown(tmp_path: Path) -> None:
    values = {"actions": np.zeros((8, 7)), "obs/eef_pos": np.ones((8, 3))}
    sources.write_demo(tmp_path / "lift.hdf5", values)
    path = sources.only(sources.imported(tmp_path / "lift.hdf5", tmp_path / "in")).path
    asked = CatalogueRequest.Show(path=path.relative_to(tmp_path / "in").as_posix())
    details = CatalogueHandlers(tmp_path / "in").answer(CatalogueRequest(show=asked)).details
    assert (list(details.views), details.episode.ticks) == ([], 7)


def test_no_folder_is_no_episodes(tmp_path: Path) -> None:
    assert listed(CatalogueHandlers(tmp_path / "none")) == []


def test_a_new_episode_is_found_when_it_is_asked_for(root: Path) -> None:
    asked = CatalogueHandlers(root)
    assert listed(asked) == [PATH]
    newer = write_episode(root, ticks=5, number=2).path.relative_to(root).as_posix()
    request = CatalogueRequest(show=CatalogueRequest.Show(path=newer))
    assert asked.answer(request).details.episode.number == 2


def test_what_people_say_is_kept_beside_the_file(root: Path) -> None:
    asked = CatalogueHandlers(root)
    said = CatalogueRequest.Label(path=PATH, outcome="failure", note="dropped it", dropped=True, by="Rita")
    episode = asked.answer(CatalogueRequest(label=said)).episode
    assert (episode.outcome, episode.note, episode.dropped) == ("failure", "dropped it", True)
    assert episode.outcome_by == "Rita"
    assert {label.by for label in labels.read(root)} == {"Rita"}
    assert {label.kind for label in labels.read(root)} == {"outcome", "note", "use"}
    again = asked.answer(CatalogueRequest(label=CatalogueRequest.Label(path=PATH, dropped=False))).episode
    assert (again.outcome, again.outcome_by, again.dropped) == ("failure", "Rita", False)
    assert show(CatalogueHandlers(root)).episode.note == "dropped it"


@pytest.mark.parametrize(
    "said",
    [
        CatalogueRequest.Label(path=PATH),
        CatalogueRequest.Label(path=PATH, outcome="great"),
        CatalogueRequest.Label(path=PATH, note="x" * 2001),
    ],
)
def test_what_cannot_be_said_is_refused(root: Path, said: CatalogueRequest.Label) -> None:
    with pytest.raises(InvalidInput):
        CatalogueHandlers(root).answer(CatalogueRequest(label=said))
    assert labels.read(root) == []


def test_the_file_comes_in_pieces(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(handlers, "PIECE_BYTES", 1000)
    asked, whole = CatalogueHandlers(root), (root / PATH).read_bytes()
    got = b""
    while len(got) < len(whole):
        piece = asked.answer(CatalogueRequest(file=CatalogueRequest.File(path=PATH, offset=len(got)))).piece
        assert 0 < len(piece.piece) <= 1000
        assert piece.size_bytes == len(whole)
        got += piece.piece
    assert got == whole
    beyond = CatalogueRequest.File(path=PATH, offset=2**60)
    assert asked.answer(CatalogueRequest(file=beyond)).piece.piece == b""


@pytest.mark.parametrize("path", ["", "../secret", "/etc/passwd", "2026-09-21", "labels.jsonl", PATH + "x"])
def test_only_what_is_listed_can_be_asked_for(root: Path, path: str) -> None:
    (root.parent / "secret").write_text("secret")
    asked = CatalogueHandlers(root)
    for request in (
        CatalogueRequest(show=CatalogueRequest.Show(path=path)),
        CatalogueRequest(file=CatalogueRequest.File(path=path)),
        CatalogueRequest(video=CatalogueRequest.Video(path=path, camera="arm0")),
        CatalogueRequest(picture=CatalogueRequest.Picture(path=path)),
        CatalogueRequest(label=CatalogueRequest.Label(path=path, dropped=True)),
    ):
        with pytest.raises(NotFound):
            asked.answer(request)


def test_a_camera_that_saw_nothing_and_pictures_that_are_none(root: Path) -> None:
    asked = CatalogueHandlers(root)
    with pytest.raises(NotFound, match="arm7"):
        asked.answer(CatalogueRequest(video=CatalogueRequest.Video(path=PATH, camera="arm7")))
    with pytest.raises(Corrupt):  # the toy camera's bytes are no pictures
        asked.answer(CatalogueRequest(picture=CatalogueRequest.Picture(path=PATH)))


def test_a_damaged_file_says_what_is_wrong(root: Path) -> None:
    (root / PATH).write_bytes(b"\x89MCAP0\r\n" + b"x" * 500)
    with pytest.raises(Corrupt):
        show(CatalogueHandlers(root))


def test_an_empty_request_is_refused(root: Path) -> None:
    with pytest.raises(InvalidInput):
        CatalogueHandlers(root).answer(CatalogueRequest())


def edit(asked: CatalogueHandlers, **wanted: Any) -> CatalogueReply.Curated:
    return asked.answer(CatalogueRequest(curate=CatalogueRequest.Curate(**wanted))).curated


def of_dataset(asked: CatalogueHandlers, name: str) -> tuple[int, list[str]]:
    listed = CatalogueRequest.List(dataset=name)
    told = asked.answer(CatalogueRequest(list=listed)).listing
    return told.matching, [f"{one.name} {one.episodes}" for one in told.datasets]


def test_a_data_set_is_put_together_by_name_or_by_filter_and_every_act_is_undone(root: Path) -> None:
    write_episode(root, ticks=5, number=2)
    asked = CatalogueHandlers(root)
    first = edit(asked, dataset="good", paths=[PATH])
    assert (first.changed, first.episodes, of_dataset(asked, "good")) == (1, 1, (1, ["good 1"]))
    everything = CatalogueRequest.List(task=synthetic.TASK, count=1)
    more = edit(asked, dataset="good", all=everything)
    assert (more.changed, more.episodes) == (1, 2)
    assert edit(asked, dataset="good", take_out=True, paths=[PATH]).episodes == 1
    undo = CatalogueRequest.Undo(dataset="good", act_ns=more.act_ns)
    assert asked.answer(CatalogueRequest(undo=undo)).curated.episodes == 0
    assert of_dataset(CatalogueHandlers(root), "good") == (0, [])


def test_episodes_of_several_rates_are_put_together(root: Path) -> None:
    rows = [
        LabelledEpisode(path=name, size_bytes=1, task=synthetic.TASK, outcome="success", control_hz=rate)
        for name, rate in (("a", 20.0), ("b", 60.0))
    ]
    assert take_in(root, "both", rows, [], now_ns=1).dataset.episodes == ("a", "b")


def test_what_cannot_be_put_together_is_refused_and_nothing_changes(root: Path) -> None:
    asked = CatalogueHandlers(root)
    other = synthetic.TASK.replace("cube", "tray")
    rows = [
        LabelledEpisode(path="a", size_bytes=1, task=synthetic.TASK),
        LabelledEpisode(path="b", size_bytes=1, task=other),
    ]
    with pytest.raises(InvalidInput, match="several tasks"):
        take_in(root, "both", rows, [], now_ns=1)
    with pytest.raises(InvalidInput, match="several tasks"):
        take_in(root, "held", rows[1:], [rows[0].model_copy(update={"datasets": ("held",)})], now_ns=1)
    with pytest.raises(InvalidInput):
        edit(asked, dataset="new", all=CatalogueRequest.List(outcome="failure"))
    with pytest.raises(InvalidInput):
        edit(asked, dataset="new")
    with pytest.raises(NotFound):
        edit(asked, dataset="new", paths=["../secret"])
    with pytest.raises(NotFound):
        asked.answer(CatalogueRequest(undo=CatalogueRequest.Undo(dataset="new", act_ns=7)))
    assert labels.read(root) == []
