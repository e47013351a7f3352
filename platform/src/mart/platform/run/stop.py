"""Stop a platform from outside: `mart stop`."""

from __future__ import annotations

import contextlib
import os
import signal
from pathlib import Path

from mart.platform.run.folder_claim import ClaimHolder, claim_holder, leftovers_of
from mart.platform.run.platform_processes import end_processes
from mart.protocol import clock
from mart.protocol.errors import NotFound

_PATIENCE_S = 60.0
_LOOK_EVERY_S = 0.1


def stop_platforms(data_dir: Path, patience_s: float = _PATIENCE_S) -> list[ClaimHolder]:
    """Return who was stopped, when all of it has ended; what does not end within `patience_s` is killed.

    A collection beside the platform is stopped as well. Raises NotFound where nothing runs with this data folder and no
    killed one has left anything.
    """
    run_dir = data_dir / "run"
    stopped = [
        holder
        for one in (run_dir, *sorted(run_dir.glob("*/")))
        if (holder := _stop(one, patience_s)) is not None
    ]
    if not stopped:
        raise NotFound(
            f"No platform runs with the data folder {data_dir.resolve()}; name another with MART_DATA_DIR."
        )
    return stopped


def _stop(run_dir: Path, patience_s: float) -> ClaimHolder | None:
    holder = claim_holder(run_dir)
    if holder is not None:
        _end(run_dir, holder, patience_s)
    else:
        holder = leftovers_of(run_dir)
    if holder is not None:
        end_processes(holder.mark, patience_s)
    return holder


def _end(run_dir: Path, holder: ClaimHolder, patience_s: float) -> None:
    with contextlib.suppress(ProcessLookupError):  # it ends just now
        os.kill(holder.pid, signal.SIGTERM)
        deadline_s = clock.monotonic_s() + patience_s
        while claim_holder(run_dir) == holder:
            if clock.monotonic_s() > deadline_s:
                os.kill(holder.pid, signal.SIGKILL)
            clock.sleep_s(_LOOK_EVERY_S)
