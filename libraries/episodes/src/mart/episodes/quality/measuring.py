"""Measure one episode: its states once, its events, commands and the times of its pictures once more."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from mart.episodes.editing import edited
from mart.episodes.hand_faults import HandFaults
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.arm_quality import arm_quality, idle_seconds
from mart.episodes.quality.measures import EpisodeQuality
from mart.episodes.quality.motion import Motion, read_motion
from mart.episodes.quality.pictures import PictureGaps
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import BARRIER_PHASE_STOPPED, Command, Event
from mart.protocol.recording import EVENT, command_topic, video_topic

_BROKEN = "link of"  # what a gateway says of a seat whose link broke
M = TypeVar("M", Event, Command)

_LOCKSTEP = "lockstep"  # paced by nobody


def measure(episode: LabelledEpisode) -> EpisodeQuality:
    """Measure an episode as people have edited it. Its pictures are counted, not decoded.

    Raises Corrupt where the file cannot be used, NotFound where it is gone, and InvalidInput, naming it, where ticks
    are missing, a number is none or nothing is left of it.
    """
    file = episode.open()
    rate_hz = file.episode.control_hz or file.room.control_hz
    if not rate_hz:
        raise InvalidInput(f"{episode.file_path} cannot be measured: it does not say its control rate.")
    try:
        motion = read_motion(file.steady_states())
    except InvalidInput as error:
        raise InvalidInput(f"{episode.file_path} cannot be measured: {error}") from error
    return _quality(episode, motion, rate_hz, _messages(file))


def _quality(episode: LabelledEpisode, motion: Motion, rate_hz: float, said: _Said) -> EpisodeQuality:
    segments = edited(motion.data, episode.edits)
    if not segments:
        raise InvalidInput(f"{episode.file_path} cannot be measured: all of it was cut out.")
    parts = [segment.ticks[:-1] for segment in segments]
    rows = np.concatenate(parts)
    lost = said.faults.transitions(motion.data.arms, motion.first_tick, len(motion.data))
    late_s = motion.late_s[rows]
    idle_s = sum(map(idle_seconds, segments))
    duration_s = len(rows) / rate_hz
    waited_s = float(late_s.sum())
    wall_s = motion.wall_s * len(rows) / len(motion.data)
    return EpisodeQuality.model_validate(
        {
            "duration_s": duration_s,
            "idle_s": idle_s,
            "idle_share": idle_s / duration_s,
            "waited_s": waited_s,
            "waited_share": min(1.0, waited_s / wall_s) if wall_s > 0 else 0.0,
            "real_time_factor": None if episode.mode == _LOCKSTEP else episode.real_time_factor,
            "missing_ticks": episode.missing_ticks,
            "missing_commands": episode.missing_commands,
            "subtask_s": {
                name: int(np.argmax(done)) / rate_hz
                for name, done in motion.data.subtasks.items()
                if done.any()
            },
            "arms": {
                name: arm_quality(segments, arm, late_s[:, arm], [lost[part, arm] for part in parts], rate_hz)
                for arm, name in enumerate(motion.data.arms)
            },
            **said.numbers,
        }
    )


@dataclass(frozen=True)
class _Said:
    """Hold what messages beside the states say: numbers by the name of the measure, and when hands were not known."""

    numbers: dict[str, float | int | None]
    faults: HandFaults


def _messages(file: EpisodeFile) -> _Said:
    cameras = dict.fromkeys([*file.episode.arms, *(file.episode.captured_cameras or ())])
    commands = set(map(command_topic, file.episode.arms))
    gaps, faults = PictureGaps(), HandFaults()
    events: list[Event] = []
    for message in file.messages(EVENT, *commands, *map(video_topic, cameras)):
        if message.topic == EVENT:
            events.append(_decoded(Event, message.payload, file))
        elif message.topic in commands:
            faults.add(_decoded(Command, message.payload, file))
        else:
            gaps.add(message.topic, message.arrived_ns)
    longest_s, share = gaps.longest_s_and_share()
    numbers = {
        "video_gap_s": longest_s,
        "video_gap_share": share,
        "link_losses": sum(_BROKEN in one.notice.text for one in events if one.HasField("notice")),
        "stops": _stops(events),
    }
    return _Said(numbers, faults)


def _decoded(kind: type[M], payload: bytes, file: EpisodeFile) -> M:
    try:
        return codec.decode(kind, payload)
    except InvalidInput as error:
        raise Corrupt(f"{file.path} holds a {kind.DESCRIPTOR.name} that cannot be read: {error}") from error


def _stops(events: Iterable[Event]) -> int:
    phases = [one.barrier_changed.phase for one in events if one.HasField("barrier_changed")]
    stopped = [phase == BARRIER_PHASE_STOPPED for phase in phases]
    return sum(now and not before for before, now in zip([False, *stopped], stopped, strict=False))
