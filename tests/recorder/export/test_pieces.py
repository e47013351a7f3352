"""An export that was interrupted goes on, and one that asks for something else is told what differs."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from mart.episodes.filter import EpisodeFilter
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Conflict, InvalidInput
from mart.recorder.catalogue.episode_catalogue import list_paths
from mart.recorder.export.pieces import half_folder, write_pieces
from mart.recorder.export.selection import ExportSelection, choose
from mart.sim.world import World
from tests.recorder.export.test_pictures import TICKS
from tests.trainer import recorded


@pytest.fixture(scope="module")
def selection(tmp_path_factory: pytest.TempPathFactory) -> ExportSelection:
    root, world = tmp_path_factory.mktemp("episodes"), World.build(recorded.TASK)
    for seed in (1, 2, 3):
        recorded.write(root, world, recorded.perform(world, seed, number=seed, most_ticks=TICKS))
    return choose(list_paths([root]), EpisodeFilter(), 20.0)


def note(_selection: ExportSelection, episode: LabelledEpisode, folder: Path) -> None:
    (folder / "number").write_text(str(episode.number))


def note_until_third(_selection: ExportSelection, episode: LabelledEpisode, folder: Path) -> None:
    if episode.number == 3:
        raise KeyboardInterrupt
    note(_selection, episode, folder)


def note_third_alone(_selection: ExportSelection, episode: LabelledEpisode, folder: Path) -> None:
    assert episode.number == 3
    note(_selection, episode, folder)


def refuse(_selection: ExportSelection, episode: LabelledEpisode, _folder: Path) -> None:
    raise InvalidInput(f"{episode.number} is not what it should be.")


def interrupt(selection: ExportSelection, target: Path) -> None:
    with pytest.raises(KeyboardInterrupt), half_folder(target, selection.asked("test")) as half:
        write_pieces(selection, half, note_until_third)


def test_what_is_whole_is_not_made_again(selection: ExportSelection, tmp_path: Path) -> None:
    target = tmp_path / "lifting"
    interrupt(selection, target)
    with half_folder(target, selection.asked("test")) as half:
        pieces = write_pieces(selection, half, note_third_alone)
        assert [(piece / "number").read_text() for piece in pieces] == ["1", "2", "3"]
    assert not [*tmp_path.iterdir()]


def test_another_export_is_told_what_differs_and_changes_nothing(
    selection: ExportSelection, tmp_path: Path
) -> None:
    target = tmp_path / "lifting"
    interrupt(selection, target)
    before = sorted(tmp_path.rglob("*"))
    other = dataclasses.replace(selection, control_hz=10.0, episodes=selection.episodes[:2])
    with pytest.raises(Conflict) as raised, half_folder(target, other.asked("test")):
        pass
    assert "control_hz (20.0, now 10.0)" in str(raised.value)
    assert "episodes (3 of them, now 2 of them)" in str(raised.value)
    assert sorted(tmp_path.rglob("*")) == before


def test_two_at_once_are_refused(selection: ExportSelection, tmp_path: Path) -> None:
    target = tmp_path / "lifting"
    with (
        half_folder(target, selection.asked("test")),
        pytest.raises(Conflict, match="Another process"),
        half_folder(target, selection.asked("test")),
    ):
        pass


@pytest.mark.slow
def test_processes_make_the_same_and_hand_on_what_they_raise(
    selection: ExportSelection, tmp_path: Path
) -> None:
    target, beside = tmp_path / "lifting", dataclasses.replace(selection, jobs=2)
    with half_folder(target, beside.asked("test")) as half:
        pieces = write_pieces(beside, half, note)
        assert [(piece / "number").read_text() for piece in pieces] == ["1", "2", "3"]
    with pytest.raises(InvalidInput, match="not what"), half_folder(target, beside.asked("test")) as half:
        write_pieces(beside, half, refuse)
    assert not [*tmp_path.iterdir()]
