"""Ask the system to let a driver go first: a busy machine holds up whoever waits in line, by a tenth of a second."""

from __future__ import annotations

import os

_PRIORITY = 10  # of 1 to 99: before everything that waits in line, behind the system's own


def go_first() -> str:
    """Have this thread, and those that it starts, scheduled in real time; returns why that cannot be, a sentence.

    Linux keeps a share of each core for the others, whatever such a thread does.
    """
    if not hasattr(os, "sched_setscheduler"):
        return "This system has no real-time scheduling that can be asked for: a busy machine may hold the driver up."
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))
    except OSError as error:
        return (
            f"Real-time scheduling was refused ({error.strerror}): a busy machine may hold the driver up, which stops "
            "the room. docs/how-to-run-real-arms.md says how to allow it."
        )
    return ""
