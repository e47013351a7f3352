"""A piece of an episode is left out where another file has all of it, and nowhere else."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import pytest

from mart.episodes import find_episodes
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.finalize import finalize
from mart.recorder.record.finalize_worker import FinalizeWorker
from mart.recorder.record.pieces import drop_pieces
from mart.recorder.record.room_models import RoomModels
from mart.runtime.bus.memory import MemoryNetwork
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_part
from tests.recorder.record.test_finalize_worker import KnownModels

TICKS = 30
NOW_NS = 1_800_000_000_000_000_000


def write_piece(root: Path, first: int, last: int) -> Path:
    """Some ticks of the episode, without its end."""
    part = write_part(root, synthetic.states(TICKS)[first : last + 1], is_over=False)
    return finalize(*part, root, by_toy_replica, repaired=True).path


def write_whole(root: Path) -> Path:
    return finalize(*write_part(root, synthetic.states(TICKS)), root, by_toy_replica, repaired=False).path


def dropped(root: Path) -> list[Path]:
    return [one.file_path for one in find_episodes(root, synthetic.ROOM, 1) if one.dropped]


def test_a_piece_of_a_whole_episode_is_left_out_whichever_came_first(tmp_path: Path) -> None:
    early = write_piece(tmp_path, 0, 10)
    assert drop_pieces(tmp_path, synthetic.ROOM, 1, NOW_NS) == []
    write_whole(tmp_path)
    late = write_piece(tmp_path, 12, TICKS)
    assert set(drop_pieces(tmp_path, synthetic.ROOM, 1, NOW_NS)) == {early, late} == set(dropped(tmp_path))
    assert drop_pieces(tmp_path, synthetic.ROOM, 1, NOW_NS) == []


@pytest.mark.parametrize(("first", "last"), [(0, 20), (15, TICKS)])
def test_pieces_without_a_whole_are_kept(tmp_path: Path, first: int, last: int) -> None:
    write_piece(tmp_path, 5, 17)
    write_piece(tmp_path, first, last)
    assert drop_pieces(tmp_path, synthetic.ROOM, 1, NOW_NS) == dropped(tmp_path) == []


def test_another_episode_of_this_number_is_no_piece(tmp_path: Path) -> None:
    write_whole(tmp_path)
    finalize(
        *write_part(tmp_path, synthetic.states(5, first_tick=9000), is_over=False),
        tmp_path,
        by_toy_replica,
        repaired=True,
    )
    assert drop_pieces(tmp_path, synthetic.ROOM, 1, NOW_NS) == []


def test_it_is_done_when_an_episode_is_saved(tmp_path: Path) -> None:
    piece = write_piece(tmp_path, 0, 10)
    announcer = Announcer(MemoryNetwork().connect(), tmp_path, "recorder-1")
    worker = FinalizeWorker(
        tmp_path, cast("RoomModels", KnownModels()), announcer, by_toy_replica, lambda: ()
    )
    worker.finalize(*write_part(tmp_path, synthetic.states(TICKS)))
    worker.close()
    assert dropped(tmp_path) == [piece]
