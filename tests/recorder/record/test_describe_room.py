"""A file says of what room it is once, with what its numbers depend on, whenever the model is known."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes.mcap_entries import state_entries
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.errors import NotFound
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import describe_room, finalize, part_path
from mart.recorder.record.room_facts import RoomFacts
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica


@pytest.mark.parametrize("known_at", [0, 1, 2, None], ids=["before", "meanwhile", "at the end", "never"])
def test_a_file_is_described_once_whenever_its_model_comes(tmp_path: Path, known_at: int | None) -> None:
    states = synthetic.states(2)
    facts = RoomFacts(synthetic.ROOM)
    facts.learn_event(
        synthetic.started(1, 0)
    )  # task, rate and the model's digest: enough to be stepped again
    episode = EpisodeAccumulator(states[0])
    file = EpisodeWriter(part_path(tmp_path, episode, facts))
    for turn, state in enumerate(states):
        describe_room(file, facts, synthetic.MODEL if known_at is not None and turn >= known_at else None)
        episode.add_state(state, state.stamps.sent_ns)
        for entry in state_entries(state, codec.encode(state), synthetic.wall_ns(state.tick), synthetic.TASK):
            file.add(entry)
        file.flush()
    saved = finalize(file, episode, facts, tmp_path, by_toy_replica, repaired=False)
    read = EpisodeFile.open(saved.path)
    if known_at is None:
        assert read.room.numeric_fingerprint is None
        with pytest.raises(NotFound):
            read.model()
    else:
        assert read.room.numerics == synthetic.NUMERICS
        assert read.model() == synthetic.MJB
