"""Say what of an episode is told on, and what became of its steps, without touching its file. Pure.

An edit is a label (labels.py), so it has an author and a time, can be undone, and two people who edit one episode at
once lose nothing: cuts, skips and splits add up, and of two words about one subtask the newer one holds. Ticks are the
recorded ones: transition t leads from state t to state t + 1.

- **cut** 12-40: transitions 12 … 39 are left out, and what is before and after them is not told as one motion.
- **skip** 12-40: they are left out as if they had not been, since nothing moved: the motion goes on after them.
- **split** 120: a new segment begins at transition 120.
- **subtask** grasp=85, grasp=never: from which state on a subtask counts as done, whatever the file says.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from itertools import pairwise

from pydantic import BaseModel, ConfigDict

from mart.protocol.errors import InvalidInput

MAX_TICK = 10_000_000  # two days at 60 Hz
NEVER = "never"
_RANGE = re.compile(r"([0-9]{1,8})-([0-9]{1,8})")
_SUBTASK = re.compile(r"([^=\s]{1,100})=([0-9]{1,8}|never)")

Range = tuple[int, int]  # ticks, the first and the one after the last


class EpisodeEdits(BaseModel):
    """Hold what is edited of one episode. Ranges are rising and do not touch one another.

    cuts, skips: ranges of transitions, each (first, one after the last). splits: rising.
    subtasks: by name the first state in which it counts as done; None where it never does.
    """

    model_config = ConfigDict(frozen=True)

    cuts: tuple[Range, ...] = ()
    skips: tuple[Range, ...] = ()
    splits: tuple[int, ...] = ()
    subtasks: Mapping[str, int | None] = {}

    def __bool__(self) -> bool:
        return bool(self.cuts or self.skips or self.splits or self.subtasks)

    def with_cut(self, value: str) -> EpisodeEdits:
        """Return these edits with one cut more. Raises InvalidInput for a value that is no range."""
        return self.model_copy(update={"cuts": _united([*self.cuts, parse_range(value)])})

    def with_skip(self, value: str) -> EpisodeEdits:
        """Return these edits with one skip more. Raises InvalidInput for a value that is no range."""
        return self.with_skips([parse_range(value)])

    def with_skips(self, ranges: Iterable[Range]) -> EpisodeEdits:
        """Return these edits with more skips."""
        return self.model_copy(update={"skips": _united([*self.skips, *ranges])})

    def with_split(self, value: str) -> EpisodeEdits:
        """Return these edits with one split more. Raises InvalidInput for a value that is no tick."""
        return self.model_copy(update={"splits": tuple(sorted({*self.splits, parse_tick(value)}))})

    def with_subtask(self, value: str) -> EpisodeEdits:
        """Return these edits with a word about a subtask. Raises InvalidInput for a value that is none."""
        name, tick = parse_subtask(value)
        return self.model_copy(update={"subtasks": {**self.subtasks, name: tick}})

    def runs(self, transitions: int) -> list[list[Range]]:
        """Return the segments that are left of so many transitions, each as the ranges that it is joined of."""
        left = _without([(0, transitions)], self.cuts)
        pieces = [piece for whole in left for piece in _split(whole, self.splits)]
        segments = [_without([piece], self.skips) for piece in pieces]
        return [segment for segment in segments if segment]

    def kept(self, transitions: int) -> int:
        """Return how many of so many transitions are left."""
        return sum(end - start for segment in self.runs(transitions) for start, end in segment)

    def values(self) -> list[tuple[str, str]]:
        """Return each edit as the kind and the value of a label."""
        subtasks = ((name, NEVER if tick is None else tick) for name, tick in sorted(self.subtasks.items()))
        return [
            *(("cut", range_text(one)) for one in self.cuts),
            *(("skip", range_text(one)) for one in self.skips),
            *(("split", str(tick)) for tick in self.splits),
            *(("subtask", f"{name}={tick}") for name, tick in subtasks),
        ]

    def __str__(self) -> str:
        return " ".join(f"{kind} {value}" for kind, value in self.values())


def parse_range(text: str) -> Range:
    """Parse `12-40`, transitions 12 … 39. Raises InvalidInput."""
    found = _RANGE.fullmatch(text)
    start, end = (int(found[1]), int(found[2])) if found else (0, 0)
    if not 0 <= start < end <= MAX_TICK:
        raise InvalidInput(
            f"The ticks {text[:100]!r} were given; name the first and the one after the last, such as 12-40, "
            f"of at most {MAX_TICK}."
        )
    return start, end


def range_text(given: Range) -> str:
    """Return a range as a label says it."""
    return f"{given[0]}-{given[1]}"


def parse_tick(text: str) -> int:
    """Parse a tick at which an episode can be split. Raises InvalidInput."""
    if not (
        text.isascii() and text.isdecimal() and len(text) <= len(str(MAX_TICK)) and 0 < int(text) <= MAX_TICK
    ):
        raise InvalidInput(f"The tick {text[:100]!r} was given; it must be a number from 1 to {MAX_TICK}.")
    return int(text)


def parse_subtask(text: str) -> tuple[str, int | None]:
    """Parse `grasp=85` or `grasp=never`. Raises InvalidInput."""
    found = _SUBTASK.fullmatch(text)
    if found is None or (found[2] != NEVER and int(found[2]) > MAX_TICK):
        raise InvalidInput(
            f"The subtask {text[:200]!r} was given; say its name and from which tick on it is done, such as grasp=85, "
            "or grasp=never."
        )
    return found[1], None if found[2] == NEVER else int(found[2])


def _united(ranges: Iterable[Range]) -> tuple[Range, ...]:
    """Return the same ticks in rising ranges that do not touch one another."""
    found: list[Range] = []
    for start, end in sorted(ranges):
        if found and start <= found[-1][1]:
            found[-1] = (found[-1][0], max(end, found[-1][1]))
        else:
            found.append((start, end))
    return tuple(found)


def _without(wholes: Iterable[Range], taken: Iterable[Range]) -> list[Range]:
    left = list(wholes)
    for start, end in taken:
        left = [
            piece
            for whole in left
            for piece in ((whole[0], min(whole[1], start)), (max(whole[0], end), whole[1]))
            if piece[0] < piece[1]
        ]
    return left


def _split(whole: Range, splits: Iterable[int]) -> list[Range]:
    inside = [tick for tick in splits if whole[0] < tick < whole[1]]
    bounds = [whole[0], *inside, whole[1]]
    return list(pairwise(bounds))
