"""Episodes that are held out: measured on, never learned from, and nothing changes where there are none."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import hashes_held_out, load_dataset
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.trainer.conftest import Recorded


@given(
    st.sets(st.text("0123456789abcdef", min_size=4, max_size=4), min_size=2),
    st.floats(0.01, 0.5),
    st.randoms(),
)
def test_a_share_of_the_episodes_is_held_out_whatever_their_order(
    hashes: set[str], share: float, random: object
) -> None:
    listed = sorted(hashes)
    found = hashes_held_out(listed, share)
    random.shuffle(listed)  # type: ignore[attr-defined]
    assert hashes_held_out(listed, share) == found
    assert 1 <= len(found) < len(hashes)
    assert abs(len(found) - share * len(hashes)) <= 1


def test_one_episode_cannot_be_spared() -> None:
    with pytest.raises(InvalidInput, match="none can be held out"):
        hashes_held_out(["a"], 0.1)


def test_every_tick_is_on_one_side(episodes: Recorded) -> None:
    whole = load_dataset([episodes.root], Selection())
    split = load_dataset([episodes.root], Selection(), held_out=0.3)
    assert whole.held_out is None
    assert split.held_out is not None
    assert len(split.starts) + len(split.held_out.starts) == len(whole.starts)
    assert split.digest.sha256 == whole.digest.sha256
    assert sum(one.held_out for one in split.digest.episodes) == 1
    assert split.digest.ticks == len(split.starts)
    assert not np.isin(split.held_out.observations[:, 0], split.observations[:, 0]).all()


def test_a_run_tells_losses_on_what_it_does_not_learn_from(episodes: Recorded, tmp_path: Path) -> None:
    spec = TrainingSpec(model="r-HBC", data=(episodes.root,), preset="debug", held_out=0.3)
    train(spec, tmp_path, threading.Event(), lambda _: None)
    rows = [json.loads(line) for line in (tmp_path / "metrics.jsonl").read_text().splitlines()]
    names = {name for row in rows for name in row if name.startswith("held_out/")}
    assert {"held_out/actor", "held_out/residual"} <= names
    assert all(np.isfinite(row[name]) for row in rows for name in names & row.keys())
