"""Hold episodes that are learned from together to one task, one control rate and the same arms. Pure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from mart.protocol.errors import InvalidInput


class ComparableEpisode(Protocol):
    """Anything that says of which task, control rate and arms it is."""

    @property
    def task(self) -> str | None: ...
    @property
    def control_hz(self) -> float | None: ...
    @property
    def arms(self) -> tuple[str, ...]: ...


def require_alike(episodes: Iterable[ComparableEpisode], advice: str) -> None:
    """Raise InvalidInput where tasks, control rates or arms differ. advice: what to do then, as a clause."""
    listed = list(episodes)
    facts: dict[str, set[str]] = {
        "tasks": {str(one.task) for one in listed},
        "control rates": {f"{one.control_hz:g} Hz" for one in listed if one.control_hz},
        "sets of arms": {" and ".join(one.arms) for one in listed},
    }
    for what, values in facts.items():
        if len(values) > 1:
            raise InvalidInput(
                f"Episodes of several {what} were given: {', '.join(sorted(values))}; {advice}."
            )
