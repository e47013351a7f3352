from __future__ import annotations

import threading
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path

import pytest

from mart.episodes import LabelKind, labels
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import CatalogueReply, CatalogueRequest, RecordedEpisode
from mart.recorder.catalogue import live_listing
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.quality_measurer import QualityMeasurer
from tests.recorder import synthetic
from tests.recorder.files import write_episode

ODD = f"2026-09-21/room-1-0009-{synthetic.TASK}.mcap"
LIKE = f"2026-09-21/room-1-0001-{synthetic.TASK}.mcap"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Eight short episodes and a long one."""
    for number in range(1, 10):
        write_episode(tmp_path, ticks=400 if number == 9 else 20, number=number)
    return tmp_path


@pytest.fixture
def quality() -> QualityMeasurer:
    return QualityMeasurer()


@pytest.fixture
def asked(root: Path, quality: QualityMeasurer, monkeypatch: pytest.MonkeyPatch) -> CatalogueHandlers:
    monkeypatch.setattr(live_listing, "_FRESH_S", 0.0)
    found = CatalogueHandlers(root, quality=quality)
    listed(found)
    return found


def listed(asked: CatalogueHandlers, *, outliers: bool = False) -> list[RecordedEpisode]:
    request = CatalogueRequest(list=CatalogueRequest.List(outliers=outliers))
    return list(asked.answer(request).listing.episodes)


def compared(asked: CatalogueHandlers, by: str = "") -> CatalogueReply.QualityComparison:
    what = CatalogueRequest.CompareQuality(task=synthetic.TASK, by=by)
    return asked.answer(CatalogueRequest(compare_quality=what)).quality_comparison


def shown(asked: CatalogueHandlers, path: str) -> CatalogueReply.QualityDetails:
    return asked.answer(
        CatalogueRequest(show_quality=CatalogueRequest.ShowQuality(path=path))
    ).quality_details


def paths(episodes: Iterable[RecordedEpisode]) -> list[str]:
    return [one.path for one in episodes]


def test_what_is_not_measured_yet_is_said_at_once(asked: CatalogueHandlers) -> None:
    assert (compared(asked).measured, compared(asked).episodes) == (0, 9)
    assert shown(asked, ODD).pending
    assert listed(asked, outliers=True) == []


def test_what_is_unlike_the_others_is_marked_and_can_be_listed(
    asked: CatalogueHandlers, quality: QualityMeasurer
) -> None:
    quality.measure_wanted()
    assert paths(listed(asked, outliers=True)) == [ODD]
    assert [one.path for one in listed(asked) if one.outliers] == [ODD]
    assert "Length: 20.0 times the median, 1 s" in listed(asked)[0].outliers


def test_an_episode_stands_beside_what_is_usual(asked: CatalogueHandlers, quality: QualityMeasurer) -> None:
    quality.measure_wanted()
    found = shown(asked, ODD)
    (length,) = [one for one in found.numbers if one.name == "duration_s"]
    assert (length.value, length.median, length.title, length.unit) == (20.0, 1.0, "Length", "s")
    assert length.outlier
    assert (found.pending, found.error, found.episodes) == (False, "", 9)
    assert {one.arm for one in found.numbers} == {"", "arm0", "arm1"}


@pytest.mark.parametrize(("by", "names"), [("", ["Ana", "hold"]), ("day", ["2026-09-21"])])
def test_people_and_days_are_compared(
    asked: CatalogueHandlers, quality: QualityMeasurer, by: str, names: list[str]
) -> None:
    quality.measure_wanted()
    found = compared(asked, by)
    assert [one.name for one in found.groups] == names
    assert (found.groups[0].episodes, found.groups[0].outliers) == (9, 1)
    assert (found.measured, found.episodes, paths(found.outliers)) == (9, 9, [ODD])


def test_a_comparison_by_anything_else_and_an_unknown_episode_are_refused(asked: CatalogueHandlers) -> None:
    with pytest.raises(InvalidInput):
        compared(asked, "shoe size")
    with pytest.raises(NotFound):
        shown(asked, "2026-09-21/none.mcap")


def test_an_edit_is_seen(asked: CatalogueHandlers, quality: QualityMeasurer, root: Path) -> None:
    quality.measure_wanted()
    labels.say(root / ODD, LabelKind.CUT, "20-400", at_ns=1)
    listed(asked)
    quality.measure_wanted()
    assert listed(asked, outliers=True) == []


def test_a_file_that_cannot_be_measured_says_why(
    asked: CatalogueHandlers, quality: QualityMeasurer, root: Path
) -> None:
    labels.say(root / LIKE, LabelKind.CUT, "0-20", at_ns=1)
    listed(asked)
    quality.measure_wanted()
    assert "all of it was cut out" in shown(asked, LIKE).error
    assert compared(asked).measured == 9


def test_outliers_alone_join_a_data_set_where_they_are_filtered(
    asked: CatalogueHandlers, quality: QualityMeasurer
) -> None:
    quality.measure_wanted()
    what = CatalogueRequest.Curate(dataset="odd", all=CatalogueRequest.List(outliers=True))
    assert asked.answer(CatalogueRequest(curate=what)).curated.changed == 1


def test_in_the_background_it_measures_what_it_sees(root: Path, quality: QualityMeasurer) -> None:
    asked, published = CatalogueHandlers(root, quality=quality), threading.Event()
    publish = quality._publish

    def told() -> None:
        publish()
        published.set()

    quality._publish = told  # type: ignore[method-assign]
    with closing(quality):
        quality.start()
        listed(asked)
        assert published.wait(30)
        assert len(quality.known) == 9
