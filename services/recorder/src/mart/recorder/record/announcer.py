"""Tell rooms what the recorder did: events on the bus, and a line in the log for each.

An event may be lost. Whoever counts on an episode asks for its file: `mart.episodes.find_episodes`, or the catalogue.
"""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from pathlib import Path

from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput
from mart.protocol.keys import Topic
from mart.protocol.messages import Event, RecordingReport, outcome_from_word
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.recorder.record.finalize import SavedEpisode
from mart.recorder.record.recorder_metrics import SAVED
from mart.runtime.bus import Bus, Publisher

_log = logging.getLogger(__name__)

_MAX_PUBLISHERS = 256
_LEVELS = {"info": logging.INFO, "warning": logging.WARNING, "error": logging.ERROR}


class Announcer:
    """Tell rooms of notices and saved episodes. Safe for several threads."""

    def __init__(self, bus: Bus, data_dir: Path, recorder: str) -> None:
        """Speak as the recorder of this name about files below `data_dir`."""
        self._bus = bus
        self._data_dir, self._recorder = data_dir, recorder
        self._publishers: OrderedDict[str, Publisher] = OrderedDict()  # by key
        self._lock = threading.Lock()

    def notice(self, room: str, level: str, text: str) -> None:
        """Tell a room in words. level: info, warning or error."""
        _log.log(_LEVELS[level], "%s: %s", room, text, extra={"room": room})
        self._put(room, Event(notice=Event.Notice(level=level, text=text, **{"from": "recorder"})))

    def report(self, room: str, boot: int, episode: int, last_tick: int) -> None:
        """Tell a room that its episode is being recorded, up to this tick."""
        report = RecordingReport(recorder=self._recorder, boot=boot, episode=episode, last_tick=last_tick)
        self._publish(keys.recording(room), codec.encode(report))

    def saved(self, saved: SavedEpisode) -> None:
        """Tell a room that an episode of it has its file."""
        episode, verification = saved.episode, saved.verification
        about = {"room": episode.room, "episode": episode.number}
        _log.info("%s: %s", episode.room, _in_words(saved), extra=about)
        SAVED.labels(verification.verdict.value).inc()
        told = Event.EpisodeSaved(
            number=episode.number,
            path=saved.path.relative_to(self._data_dir).as_posix(),
            verified=verification.verdict is Verdict.VERIFIED,
            verdict=verification.verdict.value,
            size_bytes=saved.size_bytes,
            missing_ticks=saved.cadence.missing_ticks,
            missing_commands=saved.cadence.missing_commands or 0,
        )
        if episode.outcome != EpisodeOutcome.UNSPECIFIED:
            told.outcome = outcome_from_word(episode.outcome)
        self._put(episode.room, Event(episode_saved=told, tick=episode.last_tick))
        lacks = _lacks(saved)
        if lacks:
            text = f"Episode {episode.number} was saved, but {', '.join(lacks)} in its file."
            self.notice(episode.room, "warning", text)

    def _put(self, room: str, event: Event) -> None:
        event.wall_ns = clock.wall_ns()
        event.room = room
        try:
            topic = keys.event(room)
        except InvalidInput as error:  # a repaired file may name a room that cannot exist
            _log.warning("Nobody can be told: %s", error)
        else:
            self._publish(topic, codec.encode(event))

    def _publish(self, topic: Topic, payload: bytes) -> None:
        with self._lock:
            if topic.key not in self._publishers:
                self._publishers[topic.key] = self._bus.publisher(topic)
            self._publishers.move_to_end(topic.key)
            self._publishers[topic.key].put(payload)
            while len(self._publishers) > _MAX_PUBLISHERS:
                self._publishers.popitem(last=False)[1].close()


def _in_words(saved: SavedEpisode) -> str:
    episode = saved.episode
    parts = [
        f"episode {episode.number} saved: {saved.path}",
        f"{saved.size_bytes / 1e6:.1f} MB",
        f"{episode.ticks} ticks",
        f"{episode.outcome}{'' if episode.complete else ', incomplete'}",
        f"{saved.verification.verdict.value} ({saved.verification.detail})",
    ]
    return ", ".join(parts + _lacks(saved))


def _lacks(saved: SavedEpisode) -> list[str]:
    missing = {"ticks": saved.cadence.missing_ticks, "commands": saved.cadence.missing_commands}
    return [f"{count} {what} are missing" for what, count in missing.items() if count]
