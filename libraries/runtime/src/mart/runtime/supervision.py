"""Let a supervised command end with its supervisor, also where that one is killed.

A supervisor names itself in the environment of what it starts (`SUPERVISOR_PID`). Every `mart` command that finds it
there watches that process: when it is gone, the command is asked to end, and killed where it does not.
"""

from __future__ import annotations

import os
import select
import signal
import threading

from mart.protocol import clock

SUPERVISOR_PID = "MART_SUPERVISOR_PID"
_GRACE_S = 15.0


def end_with_supervisor(grace_s: float = _GRACE_S) -> None:
    """Watch the supervisor that the environment names, if any: SIGTERM when it is gone, SIGKILL `grace_s` later.

    Raises SystemExit where it is gone already.
    """
    named = os.environ.get(SUPERVISOR_PID)
    if named is None:
        return
    try:
        supervisor = os.pidfd_open(int(named))
    except ProcessLookupError:
        raise SystemExit(1) from None
    # A signal to the process must reach the main thread, which may wait for it with sigwait.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    threading.Thread(target=_end_after, args=(supervisor, grace_s), name="supervision", daemon=True).start()
    signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_after(supervisor: int, grace_s: float) -> None:
    select.select([supervisor], [], [])
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
    clock.sleep_s(grace_s)
    os.kill(os.getpid(), signal.SIGKILL)
