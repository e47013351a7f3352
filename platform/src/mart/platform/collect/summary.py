"""What many collected episodes come to."""

from __future__ import annotations

from collections import Counter
from typing import Any

from mart.platform.collect.saved_episodes import CollectedEpisode


class CollectionSummary:
    """Add up collected episodes. `now_s`: monotonic; wall time counts from the start, that of the services included."""

    def __init__(self, now_s: float) -> None:
        self._began_s = now_s
        self._outcomes: Counter[str] = Counter()
        self._reasons: Counter[str] = Counter()
        self._verified = self._ticks = 0
        self._missing_ticks = self._missing_commands = 0
        self._simulated_s = 0.0

    def add(self, episode: CollectedEpisode) -> None:
        self._outcomes[episode.outcome] += 1
        if episode.outcome != "success":
            self._reasons[episode.reason] += 1
        self._verified += episode.verified
        self._ticks += episode.ticks
        self._missing_ticks += episode.missing_ticks
        self._missing_commands += episode.missing_commands or 0
        self._simulated_s += episode.simulated_s

    def as_json(self, now_s: float) -> dict[str, Any]:
        count, wall_s = self._outcomes.total(), now_s - self._began_s
        return {
            "count": count,
            "successes": self._outcomes["success"],
            "success_rate": self._outcomes["success"] / count if count else None,
            "failures": dict(self._reasons),
            "verified": self._verified,
            "mean_simulated_s": self._simulated_s / count if count else None,
            "ticks": self._ticks,
            "missing_ticks": self._missing_ticks,
            "missing_commands": self._missing_commands,
            "wall_s": round(wall_s, 2),
            "episodes_per_s": round(count / wall_s, 3) if wall_s > 0 else None,
        }

    def in_words(self, told: dict[str, Any]) -> str:
        reasons = ", ".join(f"{count} x {reason}" for reason, count in self._reasons.most_common())
        missing = [
            f"{told[name]} {what} are missing from the files; "
            for name, what in (("missing_ticks", "ticks"), ("missing_commands", "commands"))
            if told[name]
        ]
        return (
            f"{told['successes']} of {told['count']} episodes succeeded{f' ({reasons})' if reasons else ''}, "
            f"{told['verified']} are verified; {''.join(missing)}"
            f"{told['mean_simulated_s']:.1f} s simulated on average, "
            f"{told['wall_s']:.0f} s of wall time."
        )
