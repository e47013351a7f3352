"""Episode files of the toy room, written by the recorder's own writer."""

from __future__ import annotations

from pathlib import Path

from mart.episodes.mcap_entries import command_entry, event_entry, state_entries, video_entry
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.messages import State
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import SavedEpisode, VerifyFile, finalize, part_path
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.verify.resimulation import verify
from tests.recorder import synthetic


def by_toy_replica(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
    return verify(file, room, synthetic.ToyReplica())


def write_part(
    root: Path, states: list[State], *, flush_every: int = 5, is_over: bool = True
) -> tuple[EpisodeWriter, EpisodeAccumulator, RoomFacts]:
    """A file as it is just before it is saved: model, commands, video and events besides the states."""
    facts = RoomFacts(synthetic.ROOM)
    beginning = synthetic.started(states[0].episode, states[0].tick)
    facts.learn_event(beginning)
    facts.learn_model(synthetic.MODEL)
    episode = EpisodeAccumulator(states[0])
    episode.add_event(beginning)
    file = EpisodeWriter(part_path(root, episode, facts))
    file.describe(facts.record())
    file.attach_model(synthetic.MODEL, synthetic.wall_ns(states[0].tick))
    file.add(event_entry(beginning, codec.encode(beginning), beginning.wall_ns))
    for i, state in enumerate(states):
        _write_tick(file, episode, state)
        if i % flush_every == 0:
            file.flush()
    if is_over:
        end = synthetic.ended(states[-1].tick, states[-1].episode)
        episode.add_event(end)
        file.add(event_entry(end, codec.encode(end), end.wall_ns))
    return file, episode, facts


def _write_tick(file: EpisodeWriter, episode: EpisodeAccumulator, state: State) -> None:
    at_ns = synthetic.wall_ns(state.tick)
    command = synthetic.command(state.episode_tick + 1)
    episode.add_command("arm0", command)
    file.add(command_entry("arm0", command, codec.encode(command), at_ns))
    video = synthetic.video(state.tick, is_key=state.tick % 10 == 0)
    file.add(video_entry("arm0", video, codec.encode(video), at_ns))
    episode.add_state(state, at_ns)
    for entry in state_entries(state, codec.encode(state), at_ns, synthetic.TASK):
        file.add(entry)


def write_episode(
    root: Path, ticks: int = 30, number: int = 1, verify: VerifyFile = by_toy_replica
) -> SavedEpisode:
    file, episode, facts = write_part(root, synthetic.states(ticks, number))
    return finalize(file, episode, facts, root, verify, repaired=False)


def write_moving(root: Path, still: range, ticks: int = 30, number: int = 1, step: str = "") -> Path:
    """An episode whose first arm moves a centimetre a tick but for those that are `still`; `step` is done at last."""
    states = synthetic.states(ticks, number)
    moved_m = 0.0
    for tick, state in enumerate(states):
        moved_m += 0.0 if tick in still and tick != still[0] else 0.01
        state.arms[0].tool_in_base.x = moved_m
        if step:
            state.progress.subtasks.add(name=step, done=tick == ticks)
    return finalize(*write_part(root, states), root, by_toy_replica, repaired=False).path
