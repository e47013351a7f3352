"""What a training learns from, as it is asked for: which episodes, and of which named data set."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from mart.episodes.idle import MIN_IDLE_S
from mart.protocol.vocabulary import GOOD_VERDICTS, EpisodeOutcome, OperatorKind, Verdict


class Selection(BaseModel):
    """Which episodes are learned from, and how much of them. Empty: no such limit.

    operators: everybody who drove an arm of the episode is one of these (words as in an episode's operators).
    names: names of people, skills or policies, as recorded; every arm's driver must be one of them.
    skip_idle_s: of each episode leave out every stretch of at least so many seconds in which no arm moves.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    outcomes: tuple[EpisodeOutcome, ...] = (EpisodeOutcome.SUCCESS,)
    verdicts: tuple[Verdict, ...] = GOOD_VERDICTS
    operators: tuple[OperatorKind, ...] = ()
    names: tuple[str, ...] = ()
    first: int | None = Field(None, ge=1)  # this many episodes, the oldest
    last: int | None = Field(None, ge=1)  # the newest
    skip_idle_s: float | None = Field(None, ge=MIN_IDLE_S)


class DataSetName(BaseModel):
    """A named data set and the digest of what it held when it was asked for."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    sha256: str
