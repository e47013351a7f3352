"""Turn members of the wire's enumerations into words, and back."""

from __future__ import annotations

from typing import Any, cast

from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import EpisodeEndedBy, EpisodeOutcome, OperatorKind
from mart.v1.command_pb2 import Operator
from mart.v1.room_pb2 import ENDED_BY_UNSPECIFIED, BarrierPhase, Cue, EndedBy, EpisodePhase, Outcome
from mart.v1.trainer_pb2 import JobState


def operator_word(operator: Operator) -> OperatorKind:
    """Return the word for a member of the wire's enum: human, policy, script, hold or generated."""
    return OperatorKind(_word(Operator.Name(operator), "OPERATOR_"))


def outcome_word(outcome: Outcome) -> EpisodeOutcome:
    """Return the word for a member of the wire's enum: success, failure, discarded or unspecified."""
    return EpisodeOutcome(_word(Outcome.Name(outcome), "OUTCOME_"))


def phase_word(phase: EpisodePhase) -> str:
    """Return the word for a phase: practice, countdown, recording or ended."""
    return _word(EpisodePhase.Name(phase), "EPISODE_PHASE_")


def barrier_word(phase: BarrierPhase) -> str:
    """Return the word for the barrier's phase: running, stalled, paused or stopped."""
    return _word(BarrierPhase.Name(phase), "BARRIER_PHASE_")


def job_state_word(state: JobState) -> str:
    """Return the word for a job's state: queued, running, done, failed or cancelled."""
    return _word(JobState.Name(state), "JOB_STATE_")


def cue_word(cue: Cue) -> str:
    """Return the word for a cue: have_it, go, wait, slower, thanks, let_go or come_closer."""
    return _word(Cue.Name(cue), "CUE_")


def ended_by_word(ended_by: EndedBy) -> EpisodeEndedBy | None:
    """Return the word for what ended an episode, None where nothing says so."""
    if ended_by == ENDED_BY_UNSPECIFIED:
        return None
    return EpisodeEndedBy(_word(EndedBy.Name(ended_by), "ENDED_BY_"))


def operator_from_word(word: str) -> Operator:
    """Return the wire's member. Raises InvalidInput for anything but a word of `OperatorKind`."""
    return cast("Operator", _value(Operator, "OPERATOR_", "Operator", word))


def outcome_from_word(word: str) -> Outcome:
    """Return the wire's member. Raises InvalidInput for anything but success, failure or discarded."""
    return cast("Outcome", _value(Outcome, "OUTCOME_", "Outcome", word))


def cue_from_word(word: str) -> Cue:
    """Return the wire's member. Raises InvalidInput for any word that `cue_word` does not return."""
    return cast("Cue", _value(Cue, "CUE_", "Cue", word))


def _value(enum: Any, prefix: str, what: str, word: str) -> int:
    """Of any member but the first, which says nothing."""
    *words, last = (_word(name, prefix) for name in enum.keys()[1:])
    if word not in (*words, last):
        raise InvalidInput(f"{what} {word!r} was given; it must be {', '.join(words)} or {last}.")
    value: int = enum.Value(prefix + word.upper())
    return value


def _word(name: str, prefix: str) -> str:
    return name.removeprefix(prefix).lower()
