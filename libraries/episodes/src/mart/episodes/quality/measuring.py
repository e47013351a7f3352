"""Measure one episode: its states once, its events and the times of its pictures once more."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from mart.episodes.editing import edited
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.arm_quality import arm_quality, idle_seconds
from mart.episodes.quality.measures import EpisodeQuality
from mart.episodes.quality.motion import Motion, read_motion
from mart.episodes.quality.pictures import PictureGaps
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import BARRIER_PHASE_STOPPED, Event
from mart.protocol.recording import EVENT, video_topic

_BROKEN = "link of"  # what a gateway says of a seat whose link broke
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


def _quality(
    episode: LabelledEpisode, motion: Motion, rate_hz: float, said: dict[str, float | int | None]
) -> EpisodeQuality:
    segments = edited(motion.data, episode.edits)
    if not segments:
        raise InvalidInput(f"{episode.file_path} cannot be measured: all of it was cut out.")
    rows = np.concatenate([segment.ticks[:-1] for segment in segments])
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
                name: arm_quality(segments, arm, late_s[:, arm], rate_hz)
                for arm, name in enumerate(motion.data.arms)
            },
            **said,
        }
    )


def _messages(file: EpisodeFile) -> dict[str, float | int | None]:
    """Return what events and pictures say, by the name of the measure."""
    cameras = dict.fromkeys([*file.episode.arms, *(file.episode.captured_cameras or ())])
    topics = [video_topic(camera) for camera in cameras]
    gaps = PictureGaps()
    events: list[Event] = []
    for message in file.messages(EVENT, *topics):
        if message.topic != EVENT:
            gaps.add(message.topic, message.arrived_ns)
            continue
        try:
            events.append(codec.decode(Event, message.payload))
        except InvalidInput as error:
            raise Corrupt(f"{file.path} holds an event that cannot be read: {error}") from error
    longest_s, share = gaps.longest_s_and_share()
    return {
        "video_gap_s": longest_s,
        "video_gap_share": share,
        "link_losses": sum(_BROKEN in one.notice.text for one in events if one.HasField("notice")),
        "stops": _stops(events),
    }


def _stops(events: Iterable[Event]) -> int:
    phases = [one.barrier_changed.phase for one in events if one.HasField("barrier_changed")]
    stopped = [phase == BARRIER_PHASE_STOPPED for phase in phases]
    return sum(now and not before for before, now in zip([False, *stopped], stopped, strict=False))
