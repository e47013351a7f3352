"""Jobs on this machine: one process each, which dies with the trainer and is started anew by the next one."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

from mart.runtime.child_process import start_child, stop_child
from mart.trainer.jobs.executors.executor import JobEnded, OnEnded
from mart.trainer.jobs.job import ExitCode
from mart.trainer.jobs.job_files import LOG, why_ended

_STOP_TIMEOUT_S = 30.0


class LocalExecutor:
    """Run jobs as processes of this machine, called from one thread that lives as long as the trainer."""

    def __init__(self, slots: int, ended: OnEnded) -> None:
        self.slots = slots
        self.trouble = ""
        self._ended = ended
        self._processes: dict[int, subprocess.Popen[bytes]] = {}
        self._waiters: list[threading.Thread] = []

    def start(self, job: int, run: Path) -> None:
        run.mkdir(parents=True, exist_ok=True)
        with (run / LOG).open("ab") as log:
            process = start_child((sys.executable, "-m", "mart.trainer.jobs.worker", run), log, {})
        self._processes[job] = process
        waiter = threading.Thread(target=self._wait, args=(job, run, process), daemon=True)
        self._waiters = [thread for thread in self._waiters if thread.is_alive()] + [waiter]
        waiter.start()

    def stop(self, job: int) -> None:
        process = self._processes.get(job)
        if process is not None:
            process.terminate()
            killer = threading.Timer(_STOP_TIMEOUT_S, process.kill)
            killer.daemon = True
            killer.start()

    def close(self) -> None:
        for process in self._processes.values():
            process.terminate()
        for process in self._processes.values():
            stop_child(process)
        for waiter in self._waiters:
            waiter.join()

    def _wait(self, job: int, run: Path, process: subprocess.Popen[bytes]) -> None:
        code = process.wait()
        self._ended(JobEnded(job, code, "" if code == ExitCode.DONE else why_ended(run, code)))
