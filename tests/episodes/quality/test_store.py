from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes import LabelKind, labels, list_episodes
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality import store
from mart.episodes.quality.store import FILE_NAME, MeasuredQuality, measure_all
from tests.recorder.files import write_episode


def listed(root: Path) -> list[LabelledEpisode]:
    return list_episodes(root)


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for number in (1, 2):
        write_episode(tmp_path, ticks=40, number=number)
    return tmp_path


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The paths that were measured, as it happens."""
    found: list[str] = []
    real = store.measured

    def measured(episode: LabelledEpisode) -> MeasuredQuality:
        found.append(episode.path)
        return real(episode)

    monkeypatch.setattr(store, "measured", measured)
    return found


def test_what_was_measured_once_is_remembered(root: Path, asked: list[str]) -> None:
    first = [found for _, found in measure_all(listed(root))]
    assert len(asked) == 2
    assert [found for _, found in measure_all(listed(root))] == first
    assert len(asked) == 2
    assert first[0].quality is not None


def test_an_edit_is_measured_anew(root: Path, asked: list[str]) -> None:
    list(measure_all(listed(root)))
    edited = listed(root)[1]
    labels.say(edited.file_path, LabelKind.CUT, "0-10", at_ns=1)
    found = [found for _, found in measure_all(listed(root))]
    assert asked[2:] == [edited.path]
    assert found[1].quality is not None
    assert found[1].quality.duration_s == pytest.approx(1.5)


def test_a_file_that_cannot_be_measured_says_why(root: Path) -> None:
    broken = listed(root)[0].file_path
    content = broken.read_bytes()
    broken.write_bytes(content[: len(content) // 2])
    ((_, bad), (_, good)) = measure_all(listed(root))
    assert bad.quality is None
    assert str(broken) in bad.error
    assert good.quality is not None


def test_a_damaged_store_is_made_anew(root: Path, asked: list[str]) -> None:
    list(measure_all(listed(root)))
    (root / FILE_NAME).write_bytes(b"no database at all" * 1000)
    assert all(found.quality for _, found in measure_all(listed(root)))
    assert len(asked) == 4
    list(measure_all(listed(root)))
    assert len(asked) == 4


def test_where_nothing_can_be_written_it_is_measured_all_the_same(root: Path) -> None:
    (root / FILE_NAME).mkdir()
    assert all(found.quality for _, found in measure_all(listed(root)))
