"""Judge one row: what was told, how long the world stood, what is lost, what the files say. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from mart.protocol.messages import Event
from tools.chaos.witness import Shown

MOST_LOST_S = 1.0
TOLD_WITHIN_S = 0.5
CONTROL_HZ = 20.0
_NOT_FELT_S = 0.5  # a standstill that people take for a hesitation
_USUAL_END_S = 0.5  # of an episode: its last state and the word of its end come together


@dataclass(frozen=True)
class RecordedFile:
    """What one file of the episode holds and says."""

    ticks: frozenset[int]
    outcome: str
    verdict: str
    complete: bool
    dropped: bool = False


@dataclass
class Row:
    """What became of one fault. Times in seconds from its beginning; None: never."""

    fault: str
    felt_s: float = 0.0  # when people could first notice it: where the platform ends, with its last state
    standstill_s: float = 0.0
    back_s: float = 0.0
    told_s: float | None = None
    told: str = ""
    lost_s: float = 0.0
    episode: str = ""
    gap_named: bool = True
    next_verified: bool = False
    left_over: int = 0
    next_start_s: float | None = None
    not_here: str = ""
    short: list[str] = field(default_factory=list)


def standstill(
    states: Sequence[tuple[float, int, int]], events: Sequence[tuple[float, Event]], fault_s: float
) -> tuple[float, float]:
    """Return the longest time without a state after the fault, and when the last such longer than a hesitation ended.

    The pause at an episode's usual end is none.
    """
    ends = [at_s for at_s, event in events if event.HasField("episode_ended")]
    times = [at_s for at_s, _, _ in states]
    longest, back_s = 0.0, 0.0
    for before_s, after_s in pairwise(times):
        if after_s < fault_s or any(abs(end_s - before_s) < _USUAL_END_S for end_s in ends):
            continue
        gap_s = after_s - max(before_s, fault_s)
        longest = max(longest, gap_s)
        if gap_s > _NOT_FELT_S:
            back_s = after_s - fault_s
    return longest, back_s


def told(shown: Sequence[Shown], names: Sequence[str], fault_s: float) -> tuple[float | None, str]:
    """Return when the first words that hold one of `names` were shown after the fault, and the words."""
    for one in shown:
        if one.at_s >= fault_s and any(name.lower() in one.words.lower() for name in names):
            return one.at_s - fault_s, one.words
    return None, ""


def lost(expected: frozenset[int], files: Sequence[RecordedFile]) -> float:
    """Return how much of the episode is in no file, in seconds."""
    recorded: frozenset[int] = frozenset().union(*(file.ticks for file in files))
    return len(expected - recorded) / CONTROL_HZ


def in_words(files: Sequence[RecordedFile], expected: frozenset[int]) -> str:
    """Return what the files say of the episode."""
    if not files:
        return "no file"
    return "; ".join(
        f"{file.outcome}, {file.verdict}, {len(file.ticks)} of {len(expected)} ticks"
        f"{'' if file.complete else ', says that it is not whole'}{', left out' if file.dropped else ''}"
        for file in files
    )


def judge(row: Row, names: Sequence[str], *, felt: bool, ends_platform: bool) -> list[str]:
    """Return where the row falls short of what is promised, in words. `felt`: people had something to notice."""
    short = []
    if row.lost_s > MOST_LOST_S:
        short.append(f"{row.lost_s:.1f} s are lost")
    if not row.gap_named:
        short.append("neither verified nor its gap named")
    if names and felt and row.told_s is None:
        short.append("nobody is told")
    elif names and felt and row.told_s is not None and row.told_s - row.felt_s > TOLD_WITHIN_S:
        short.append(f"told {row.told_s - row.felt_s:.1f} s after it is felt")
    if not row.next_verified:
        short.append("the next episode is not verified")
    if row.left_over:
        short.append(f"{row.left_over} processes are left")
    if ends_platform and row.next_start_s is None:
        short.append("the next start fails")
    return short
