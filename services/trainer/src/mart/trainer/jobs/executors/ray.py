"""Jobs on an existing Ray cluster (https://www.ray.io), a sweep spread over its nodes.

The driver is a process of its own: where the cluster's head is lost, Ray ends the driver and not the trainer. Its jobs
go back into the queue and are started again once the head is there; what the lost attempts had written is gone on with.
"""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO

from mart.protocol import clock
from mart.trainer import leash
from mart.trainer.jobs.executors.executor import Ended, OnEnded
from mart.trainer.jobs.job import End
from mart.trainer.jobs.order import why_ended

_AGAIN_S = 5.0  # between attempts to reach a head that is away


class RayExecutor:
    """`address`: of the head, like 10.0.0.5:6379. `log`: what the driver prints. Its methods are one thread's."""

    def __init__(self, address: str, log: Path, ended: OnEnded) -> None:
        self._address = address
        self._log = log
        self._ended = ended
        self._lock = threading.Lock()
        self._runs: dict[int, Path] = {}
        self._driver: subprocess.Popen[bytes] | None = None
        self._slots = 0
        self._not_before_s = 0.0

    @property
    def slots(self) -> int:
        """0 until a driver is connected; asking for it starts one."""
        if self._driver is None and clock.monotonic_s() >= self._not_before_s:
            self._connect()
        return self._slots

    @property
    def trouble(self) -> str:
        return "" if self._slots else f"waits for the Ray cluster at {self._address}, which does not answer"

    def start(self, job: int, run: Path) -> None:
        with self._lock:
            self._runs[job] = run
        self._say(start=job, run=str(run))

    def stop(self, job: int) -> None:
        self._say(stop=job)

    def close(self) -> None:
        driver = self._driver
        if driver is not None:
            assert driver.stdin is not None
            driver.stdin.close()
            leash.stop(driver)

    def _connect(self) -> None:
        self._log.parent.mkdir(parents=True, exist_ok=True)
        command = (sys.executable, "-m", "mart.trainer.jobs.executors.ray_driver", self._address)
        with self._log.open("ab") as log:
            self._driver = leash.start(
                command, log, {"RAY_gcs_rpc_server_reconnect_timeout_s": "5"}, piped=True
            )
        assert self._driver.stdout is not None
        threading.Thread(target=self._listen, args=(self._driver, self._driver.stdout), daemon=True).start()

    def _say(self, **fields: int | str) -> None:
        """A driver that is gone is told of by `_listen`, together with its jobs."""
        driver = self._driver
        if driver is not None and driver.stdin is not None:
            try:
                driver.stdin.write(json.dumps(fields).encode() + b"\n")
                driver.stdin.flush()
            except BrokenPipeError:
                self._slots = 0

    def _listen(self, driver: subprocess.Popen[bytes], lines: IO[bytes]) -> None:
        for line in lines:
            said = json.loads(line)
            if "slots" in said:
                self._slots = said["slots"]
            else:
                self._tell(said["ended"], said["code"])
        driver.wait()
        self._slots = 0
        self._not_before_s = clock.monotonic_s() + _AGAIN_S
        self._driver = None
        with self._lock:
            lost = list(self._runs)
        for job in lost:
            self._tell(job, End.LOST)

    def _tell(self, job: int, code: int) -> None:
        with self._lock:
            run = self._runs.pop(job, None)
        if run is None:
            return
        if code == End.DONE:
            self._ended(Ended(job, code))
        elif code == End.LOST:
            self._ended(Ended(job, code, f"waits for the Ray cluster at {self._address}, which was lost"))
        else:
            self._ended(Ended(job, code, why_ended(run, code)))
