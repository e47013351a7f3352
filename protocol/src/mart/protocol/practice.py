"""Say what goes together in a room for practice, in which nothing is recorded."""

from __future__ import annotations

from mart.protocol.errors import InvalidInput


def require_practice_alone(
    *, practice: bool, course_required: bool, episodes: int, lockstep: bool = False
) -> None:
    """Raise InvalidInput where a room for practice is asked for what recordings are for.

    episodes: good ones that are wanted, 0: no plan.
    """
    against = {
        "the required course": course_required,
        "the wanted episodes": bool(episodes),
        "lockstep": lockstep,
    }
    what = " and ".join(words for words, asked in against.items() if asked)
    if practice and what:
        raise InvalidInput(
            f"A practice room records nothing: leave out {what}, or let it be no practice room."
        )
