"""Editing over the bus: what the Episodes page asks a catalogue."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import CatalogueReply, CatalogueRequest, Edit
from mart.recorder.catalogue.handlers import CatalogueHandlers
from tests.recorder import synthetic
from tests.recorder.files import write_episode, write_moving

PATH = f"2026-09-21/room-1-0001-{synthetic.TASK}.mcap"


@pytest.fixture
def answers(tmp_path: Path) -> CatalogueHandlers:
    write_episode(tmp_path, ticks=30, number=1)
    return CatalogueHandlers(tmp_path)


def edit(answers: CatalogueHandlers, *edits: tuple[str, str], by: str = "Ana") -> CatalogueReply.Edited:
    said = [Edit(kind=kind, value=value) for kind, value in edits]
    asked = CatalogueRequest.EditEpisode(path=PATH, edits=said, by=by)
    return answers.answer(CatalogueRequest(edit=asked)).edited


def undo(answers: CatalogueHandlers, act_ns: int = 0) -> CatalogueReply.Edited:
    asked = CatalogueRequest.UndoEdit(path=PATH, act_ns=act_ns, by="Ben")
    return answers.answer(CatalogueRequest(undo_edit=asked)).edited


def cuts(told: CatalogueReply.Edited) -> list[tuple[int, int]]:
    return [(one.begin, one.end) for one in told.edits.cuts]


def test_an_edit_is_told_with_who_said_it(answers: CatalogueHandlers) -> None:
    told = edit(answers, ("cut", "0-3"), ("split", "20"))
    assert (told.edits.kept_ticks, told.edits.segments) == (27, 2)
    assert (told.episode.kept_ticks, told.episode.segments) == (27, 2)
    (act,) = told.edits.acts
    assert (act.act_ns, act.by) == (told.act_ns, "Ana")
    assert [(one.kind, one.value) for one in act.edits] == [("cut", "0-3"), ("split", "20")]
    assert edit(answers).edits == told.edits
    assert edit(answers).act_ns == 0


def test_details_tell_ticks_and_seconds(answers: CatalogueHandlers) -> None:
    edit(answers, ("cut", "0-3"))
    details = answers.answer(CatalogueRequest(show=CatalogueRequest.Show(path=PATH))).details
    assert details.edits.kept_ticks == 27
    assert list(details.tick_times.ticks) == list(range(31))
    assert details.tick_times.seconds[-1] == details.wall_s


def test_an_act_is_undone_by_its_stamp_whoever_came_later(answers: CatalogueHandlers) -> None:
    first = edit(answers, ("cut", "0-3"))
    edit(answers, ("cut", "10-12"), by="Ben")
    assert cuts(undo(answers, first.act_ns)) == [(10, 12)]
    undone = undo(answers)
    assert cuts(undone) == []
    assert not undone.episode.HasField("kept_ticks")
    assert cuts(undo(answers, undone.act_ns)) == [(10, 12)]  # of an undo: what holds again
    with pytest.raises(NotFound, match="Nothing that holds"):
        undo(answers, first.act_ns)


def test_two_who_edit_at_once_lose_nothing(answers: CatalogueHandlers, tmp_path: Path) -> None:
    """Two catalogues of one folder, as a command line beside the page: neither knows what the other has just said."""
    other = CatalogueHandlers(tmp_path)
    edit(other)
    with ThreadPoolExecutor(2) as both:
        said = [
            both.submit(edit, one, ("cut", f"{tick}-{tick + 1}"), by=name)
            for tick in range(0, 20, 2)
            for one, name in [((answers, "Ana"), (other, "Ben"))[tick % 4 // 2]]
        ]
        stamps = {one.result().act_ns for one in said}
    assert len(stamps) == 10
    for one in (answers, other):
        told = edit(one)
        assert cuts(told) == [(tick, tick + 1) for tick in range(0, 20, 2)]
        assert {act.by for act in told.edits.acts} == {"Ana", "Ben"}


def test_labels_are_undone_by_their_stamp_too(answers: CatalogueHandlers, tmp_path: Path) -> None:
    label = CatalogueRequest.Label(path=PATH, outcome="failure", by="Ana")
    answers.answer(CatalogueRequest(label=label))
    (said,) = labels.read(tmp_path)
    assert undo(answers, said.at_ns).episode.outcome == "success"


def test_a_data_set_is_not_undone_here(answers: CatalogueHandlers, tmp_path: Path) -> None:
    labels.append(tmp_path, [labels.Label(PATH, labels.LabelKind.JOIN, "good", 5)])
    with pytest.raises(InvalidInput, match="mart datasets undo"):
        undo(answers, 5)


@pytest.mark.parametrize("bad", [("cut", "0-31"), ("cut", "x"), ("outcome", "success"), ("split", "30")])
def test_what_cannot_be_is_refused(answers: CatalogueHandlers, tmp_path: Path, bad: tuple[str, str]) -> None:
    with pytest.raises(InvalidInput):
        edit(answers, ("cut", "1-2"), bad)
    assert not (tmp_path / labels.FILE_NAME).exists()


def test_idle_time_becomes_skips(tmp_path: Path) -> None:
    write_moving(tmp_path, still=range(10, 21))
    asked = CatalogueRequest.EditEpisode(path=PATH, skip_idle_s=0.5)
    told = CatalogueHandlers(tmp_path).answer(CatalogueRequest(edit=asked)).edited
    assert [(one.begin, one.end) for one in told.edits.skips] == [(10, 20)]
