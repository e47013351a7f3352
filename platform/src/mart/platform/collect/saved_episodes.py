"""Find the episodes of a collection by their files: what is on the disk counts, whatever was said on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mart.episodes import LabelledEpisode, find_episodes
from mart.episodes.reader import EpisodeFile
from mart.protocol import clock
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.messages import Event
from mart.protocol.recording import SUFFIX
from mart.protocol.vocabulary import EpisodeOutcome, Verdict


@dataclass(frozen=True)
class CollectedEpisode:
    """Hold what one recorded episode came to. `path` is relative to the data folder.

    `latencies`: motion to photon by seat, none where no page was watching. `real_time_factor` is None for an episode
    of a single tick.
    """

    number: int
    seed: int | None
    skill: str
    path: str
    outcome: EpisodeOutcome
    reason: str
    ticks: int
    simulated_s: float
    real_time_factor: float | None
    verdict: Verdict
    missing_ticks: int = 0
    missing_commands: int | None = None
    latencies: tuple[Event.Latency, ...] = ()

    @property
    def verified(self) -> bool:
        """Whether re-simulation gave the recorded states bit for bit."""
        return self.verdict is Verdict.VERIFIED

    def in_words(self, path: str) -> str:
        """Return one line for people; `path` is where its file lies."""
        why = f" ({self.reason})" if self.reason else ""
        return f"{self.outcome}{why}  {self.simulated_s:.1f} s  {self.verdict}  {path}"

    def as_json(self) -> dict[str, Any]:
        """Return what `mart collect` and `mart demo` print of it."""
        worst = max(self.latencies, key=lambda latency: latency.p95_ms, default=None)
        factor = self.real_time_factor
        return {
            "path": self.path,
            "outcome": self.outcome,
            "reason": self.reason,
            "skill": self.skill or None,
            "seed": self.seed,
            "ticks": self.ticks,
            "simulated_s": round(self.simulated_s, 3),
            "real_time_factor": None if factor is None else round(factor, 4),
            "motion_to_photon_p50_ms": round(worst.p50_ms, 1) if worst else None,
            "motion_to_photon_p95_ms": round(worst.p95_ms, 1) if worst else None,
            "motion_to_photon": {latency.arm: _latency_json(latency) for latency in self.latencies},
            "missing_ticks": self.missing_ticks,
            "missing_commands": self.missing_commands,
            "verified": self.verified,
            "verdict": self.verdict,
        }


VERDICT_PATIENCE_S = (
    45.0  # for one that could not be had at first; a collection replaces what is lost for 60 s
)

# Of a room and the number of an episode: the episode, once it is saved.
FindEpisode = Callable[[str, int], CollectedEpisode | None]


class SavedEpisodes:
    """Look for episodes below `data_dir/episodes` that were not there when this object was made."""

    def __init__(self, data_dir: Path) -> None:
        self._data_dir = data_dir
        self._before = frozenset((data_dir / "episodes").glob(f"*/*{SUFFIX}"))
        self._seen_s: dict[Path, float] = {}

    def find(self, room: str, number: int) -> CollectedEpisode | None:
        """Return episode `number` of `room`; None while it has no file, or for a while no verdict.

        An episode that a restart of the recorder cut has several files; the one that knows the outcome counts.
        Raises Corrupt where a file is no episode.
        """
        found = {one.file_path: one for one in find_episodes(self._data_dir / "episodes", room, number)}
        new = [found[path] for path in sorted(found.keys() - self._before)]
        ended = [one for one in new if one.outcome != EpisodeOutcome.UNSPECIFIED]
        chosen = next(iter(ended or new), None)
        if chosen is None or self._is_awaited(chosen):
            return None
        return read_collected(chosen, self._data_dir)

    def _is_awaited(self, episode: LabelledEpisode) -> bool:
        """Tell whether its verdict, which could not be had when it was saved, may still come."""
        now_s = clock.monotonic_s()
        seen_s = self._seen_s.setdefault(episode.file_path, now_s)
        return episode.verification_pending and now_s - seen_s < VERDICT_PATIENCE_S


def read_collected(found: LabelledEpisode, data_dir: Path) -> CollectedEpisode:
    """Return what an episode's file says of itself, and its newest verdict; raises Corrupt where it is no episode."""
    path = found.file_path
    file = EpisodeFile.open(path)
    episode, cadence = file.episode, file.cadence
    return CollectedEpisode(
        number=episode.number,
        seed=episode.seed,
        skill=episode.skill or "",
        path=path.relative_to(data_dir).as_posix(),
        outcome=EpisodeOutcome(episode.outcome),
        reason=episode.reason,
        ticks=episode.ticks,
        simulated_s=episode.ticks / (episode.control_hz or DEFAULT_CONTROL_HZ),
        real_time_factor=cadence.real_time_factor,
        verdict=Verdict(found.verdict),
        missing_ticks=cadence.missing_ticks,
        missing_commands=cadence.missing_commands,
        latencies=tuple(
            Event.Latency(arm=arm, p50_ms=p50_ms, p95_ms=cadence.motion_to_photon_p95_ms.get(arm, p50_ms))
            for arm, p50_ms in sorted(cadence.motion_to_photon_p50_ms.items())
        ),
    )


def _latency_json(latency: Event.Latency) -> dict[str, Any]:
    return {
        "p50_ms": round(latency.p50_ms, 1),
        "p95_ms": round(latency.p95_ms, 1),
        "frames": latency.frames,
        "stages_p50_ms": {stage.name: round(stage.p50_ms, 2) for stage in latency.stages},
    }
