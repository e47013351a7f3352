"""When files begin and end: every order in which messages can arrive gives one file an episode, with all its states."""

from __future__ import annotations

from mart.protocol import codec, recording
from mart.protocol.messages import BARRIER_PHASE_PAUSED, BARRIER_PHASE_RUNNING, Event
from mart.recorder.record.episode_closing import GRACE_S, LINGER_S, SILENCE_S
from mart.recorder.record.newest_pictures import has_key_frame
from mart.recorder.record.room_tracker import CloseFile, OpenFile
from tests.recorder import synthetic
from tests.recorder.record.driven_room import DrivenRoom, practice


def test_an_episode_runs_from_its_reset_to_its_outcome() -> None:
    room = DrivenRoom()
    room.state(practice(0))
    room.event(synthetic.started(tick=1))
    room.states(synthetic.states(5, first_tick=1))
    room.event(synthetic.ended(6))
    room.wait(LINGER_S)
    assert room.course == [OpenFile, CloseFile]
    assert room.ticks == [1, 2, 3, 4, 5, 6]
    assert len(room.entries(recording.EVENT)) == 2
    assert room.closed[0].episode.record(room.tracker.facts).complete


def test_an_outcome_may_overtake_the_last_state() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5)[:-1])
    room.event(synthetic.ended(5))
    room.wait(GRACE_S / 2)
    room.states(synthetic.states(5)[-1:])
    room.wait(LINGER_S)
    assert room.course == [OpenFile, CloseFile]
    assert room.closed[0].episode.has_all


def test_an_outcome_may_come_after_the_next_practice_has_begun() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5))
    room.state(practice(6))
    room.event(synthetic.ended(5))
    room.wait(LINGER_S)
    assert room.ticks == [0, 1, 2, 3, 4, 5]
    assert room.closed[0].episode.has_all


def test_a_room_repeats_its_last_state_after_the_end() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5))
    room.event(synthetic.ended(5))
    for _ in range(10):
        room.wait(LINGER_S)
        room.states(synthetic.states(5)[-1:])
    assert room.course == [OpenFile, CloseFile]


def test_an_episode_without_an_outcome_ends_when_the_next_begins() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(3))
    room.states(synthetic.states(3, number=2, first_tick=10))
    room.wait(GRACE_S)
    assert room.course == [OpenFile, OpenFile, CloseFile]
    assert room.closed[0].episode.record(room.tracker.facts).outcome == "unspecified"
    assert room.closed[0].episode.unfinished_reason == "the next one began"


def test_a_restarted_sim_ends_the_episode() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(3))
    room.status(synthetic.status(boot=78))
    room.wait(GRACE_S)
    assert room.course == [OpenFile, CloseFile]
    assert room.closed[0].episode.unfinished_reason == "the sim restarted"


def test_a_silent_sim_ends_the_episode_but_a_paused_room_does_not() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(3))
    for _ in range(100):
        room.wait(SILENCE_S / 5)
        room.status(synthetic.status())
    assert room.course == [OpenFile]
    room.wait(SILENCE_S + 1)
    assert room.course == [OpenFile, CloseFile]


def test_after_an_outage_the_rest_is_recorded_too() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(10)[:4])
    room.wait(SILENCE_S + 1)
    room.states(synthetic.states(10)[6:])
    assert room.course == [OpenFile, CloseFile, OpenFile]
    assert room.ticks == [0, 1, 2, 3, 6, 7, 8, 9, 10]


def test_an_abandoned_episode_is_left_alone_and_the_next_is_recorded() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(10)[:4])
    assert room.tracker.episode is not None
    room.tracker.abandon(room.tracker.episode)
    room.states(synthetic.states(10)[4:])
    room.states(synthetic.states(2, number=2, first_tick=20))
    assert room.course == [OpenFile, OpenFile]
    assert room.ticks == [0, 1, 2, 3, 20, 21, 22]


def test_what_happened_before_an_episode_or_after_it_is_not_in_its_file() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5, first_tick=10))
    for tick in (7, 12, 0):
        phase = BARRIER_PHASE_PAUSED if tick == 7 else BARRIER_PHASE_RUNNING
        room.event(Event(tick=tick, barrier_changed=Event.BarrierChanged(phase=phase)))
    room.state(practice(16))
    for tick in (14, 17):
        room.event(Event(tick=tick, barrier_changed=Event.BarrierChanged(phase=BARRIER_PHASE_RUNNING)))
    room.event(synthetic.ended(15))
    room.wait(LINGER_S)
    written = [Event.FromString(entry.payload).tick for entry in room.entries(recording.EVENT)]
    assert written == [12, 0, 14, 15]
    assert not room.closed[0].episode.interrupted


def test_what_came_just_before_belongs_to_the_episode() -> None:
    room = DrivenRoom()
    for sequence in (5, 6, 7, 9, 8):
        room.command(synthetic.command(sequence))
    for frame in range(25):
        video = synthetic.video(frame, is_key=frame in (0, 20))
        room.tracker.video("arm0", video, codec.encode(video), synthetic.wall_ns(0) - 1000 + frame)
    room.event(synthetic.started())
    reset, first = synthetic.states(1)
    first.arms[0].sequence = 7
    room.only_state(reset)
    room.only_state(first)
    assert [entry.sequence for entry in room.entries("/arm/arm0/command")] == [6, 7, 8, 9]
    assert len(room.entries("/view/arm0/video")) == 5
    assert len(room.entries(recording.EVENT)) == 1


def test_what_came_long_before_does_not() -> None:
    room = DrivenRoom()
    command = synthetic.command(0)
    at_ns = synthetic.wall_ns(0) - 60_000_000_000
    room.tracker.command("arm0", command, codec.encode(command), at_ns, room.now_s)
    room.states(synthetic.states(1))
    assert [entry.sequence for entry in room.entries("/arm/arm0/command")] == [1]


def test_key_frames_are_found_in_annex_b() -> None:
    parameters, idr, slice_ = b"\x00\x00\x00\x01\x67\x42", b"\x00\x00\x01\x65\x88", b"\x00\x00\x01\x41\x9a"
    assert has_key_frame(parameters + idr)
    assert has_key_frame(slice_ + idr)
    assert not has_key_frame(slice_ * 3)
    assert not has_key_frame(b"")
    assert not has_key_frame(b"\x00\x00\x01")
