from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mart.episodes import list_episodes, open_episode
from mart.episodes.arrays import EpisodeData, arrays_from_states
from mart.episodes.edits import EpisodeEdits
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.mcap_entries import command_entry, event_entry
from mart.episodes.quality import measure
from mart.episodes.quality.motion import read_motion
from mart.episodes.quality.pictures import PictureGaps
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STOPPED,
    HAND_FAULT_TRACKING,
    HAND_FAULT_UNSPECIFIED,
    BarrierPhase,
    Command,
    Event,
    State,
)
from mart.recorder.record.finalize import finalize
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part


def only(root: Path) -> LabelledEpisode:
    (found,) = list_episodes(root)
    return found


def barrier(phase: BarrierPhase, tick: int) -> Event:
    return Event(wall_ns=synthetic.wall_ns(tick), barrier_changed=Event.BarrierChanged(phase=phase))


def test_what_messages_say_is_counted(tmp_path: Path) -> None:
    file, episode, facts = write_part(tmp_path, synthetic.states(40))
    broke = Event.Notice(level="warning", text="The link of arm0 broke and is being restored.")
    said = [
        barrier(BARRIER_PHASE_STOPPED, 5),
        barrier(BARRIER_PHASE_STOPPED, 6),
        barrier(BARRIER_PHASE_RUNNING, 7),
        barrier(BARRIER_PHASE_STOPPED, 9),
        Event(wall_ns=synthetic.wall_ns(10), notice=broke),
    ]
    for event in said:
        file.add(event_entry(event, codec.encode(event), event.wall_ns))
    finalize(file, episode, facts, tmp_path, by_toy_replica, repaired=False)
    found = measure(only(tmp_path))
    assert (found.stops, found.link_losses, found.duration_s) == pytest.approx((2, 1, 2.0))
    assert (found.missing_ticks, found.missing_commands) == (0, 0)
    assert found.waited_s == pytest.approx(0.4)
    assert found.arms["arm1"].waited_s == pytest.approx(0.4)
    assert found.arms["arm1"].held_share == 1.0
    assert found.arms["arm0"].held_share == 0.0
    assert found.video_gap_s == pytest.approx(0.05)
    assert found.video_gap_share == 0.0


def test_losses_of_a_phone_are_counted_where_edits_leave_them(tmp_path: Path) -> None:
    file, episode, facts = write_part(tmp_path, synthetic.states(40, first_tick=100))
    lost = {*range(110, 130), 135, 99, 140}  # before the first state and after the last transition: not of it
    for number, tick in enumerate(range(98, 141)):
        said = Command(arm="arm0", sequence=1000 + number, state_tick=tick)
        said.hand_fault = HAND_FAULT_TRACKING if tick in lost else HAND_FAULT_UNSPECIFIED
        file.add(command_entry("arm0", said, codec.encode(said), synthetic.wall_ns(tick)))
    finalize(file, episode, facts, tmp_path, by_toy_replica, repaired=False)
    found = measure(only(tmp_path)).arms["arm0"]
    assert (found.phone_losses, found.phone_lost_s) == pytest.approx((2, 21 / 20))
    assert found.phone_lost_share == pytest.approx(21 / 40)
    found = measure(only(tmp_path).model_copy(update={"edits": EpisodeEdits().with_cut("0-20")})).arms["arm0"]
    assert (found.phone_losses, found.phone_lost_s) == pytest.approx((2, 11 / 20))
    cut = EpisodeEdits().with_cut("0-20").with_cut("20-30")
    assert measure(only(tmp_path).model_copy(update={"edits": cut})).arms["arm0"].phone_losses == 1


def test_a_motion_is_what_arrays_say(tmp_path: Path) -> None:
    states = list(open_episode(write_episode(tmp_path, ticks=20).path).states())
    data, arrays = read_motion(iter(states)).data, arrays_from_states(states)
    for name in (
        "sources",
        "engaged",
        "held",
        "sim_time_s",
        "sent_ns",
        "tool_positions_in_base",
        "success",
        "ticks",
    ):
        np.testing.assert_array_equal(getattr(data, name), getattr(arrays, name))
    np.testing.assert_array_equal(data.actions[..., 6], arrays.actions[..., 6])
    assert isinstance(data, EpisodeData)


def _other_arms(states: list[State]) -> None:
    del states[5].arms[0]


def _no_number(states: list[State]) -> None:
    states[5].arms[0].tool_in_base.x = float("nan")


def _missing_tick(states: list[State]) -> None:
    del states[5]


def _one(states: list[State]) -> None:
    del states[1:]


@pytest.mark.parametrize("damage", [_other_arms, _no_number, _missing_tick, _one])
def test_what_cannot_be_measured_is_refused(damage: object) -> None:
    states = synthetic.states(20)
    damage(states)  # type: ignore[operator]  # a function above
    with pytest.raises(InvalidInput):
        read_motion(states)


def test_an_unreadable_file_is_corrupt(tmp_path: Path) -> None:
    path = write_episode(tmp_path, ticks=20).path
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(Corrupt):
        measure(only(tmp_path))


def test_a_pause_of_a_video_is_told_against_its_rate() -> None:
    gaps = PictureGaps()
    for frame in [*range(30), *range(60, 91)]:
        gaps.add("arm0", frame * 33_000_000)
    longest_s, share = gaps.longest_s_and_share()
    assert longest_s == pytest.approx(31 * 0.033)
    assert share == pytest.approx(31 / 90)
    assert PictureGaps().longest_s_and_share() == (None, None)
