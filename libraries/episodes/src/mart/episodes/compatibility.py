"""Hold episodes that are learned from together to one task, one control rate and the same kinds of arms. Pure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from mart.protocol.arms import PANDA
from mart.protocol.errors import InvalidInput


class ComparableEpisode(Protocol):
    """Anything that says of which task, control rate and arms it is."""

    @property
    def task(self) -> str | None: ...
    @property
    def control_hz(self) -> float | None: ...
    @property
    def arms(self) -> tuple[str, ...]: ...
    @property
    def arm_kinds(self) -> tuple[str, ...]: ...


def require_alike(episodes: Iterable[ComparableEpisode], advice: str, *, any_rate: bool = False) -> None:
    """Raise InvalidInput where tasks, arms or, but for `any_rate`, control rates differ.

    advice: what to do then, as a clause. any_rate: they are told at one rate (`mart.episodes.resampling`).
    """
    listed = list(episodes)
    rates = {f"{one.control_hz:g} Hz" for one in listed if one.control_hz}
    if len(rates) > 1 and not any_rate:
        raise InvalidInput(
            f"Episodes of several control rates were given: {', '.join(sorted(rates))}; "
            f"say one to take them at, at most the lowest of these, such as --control-hz {_lowest(listed):g}."
        )
    facts: dict[str, set[str]] = {
        "tasks": {str(one.task) for one in listed},
        "sets of arms": {" and ".join(one.arms) for one in listed},
        "kinds of arms (arm_kinds)": {
            " and ".join(one.arm_kinds or (PANDA.name,) * len(one.arms)) for one in listed
        },
    }
    for what, values in facts.items():
        if len(values) > 1:
            raise InvalidInput(
                f"Episodes of several {what} were given: {', '.join(sorted(values))}; {advice}."
            )


def _lowest(episodes: Iterable[ComparableEpisode]) -> float:
    return min(one.control_hz for one in episodes if one.control_hz)
