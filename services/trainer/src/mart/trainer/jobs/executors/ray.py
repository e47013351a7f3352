"""Jobs on an existing Ray cluster (https://www.ray.io), a sweep spread over its nodes.

The driver is a process of its own: where the cluster's head is lost, Ray ends the driver and not the trainer. Its jobs
go back into the queue and are started again once the head is there; what the lost attempts had written is gone on with.
Ray is slow to end its driver, and the driver takes jobs until then; so we end it: where a job was lost and the head
does not answer, where the head has not answered for a while, and where the driver has not connected in time.
"""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import threading
from functools import partial
from pathlib import Path
from typing import IO

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.runtime.child_process import start_child, stop_child
from mart.runtime.watchdog import start_vital_thread
from mart.trainer.jobs.executors.executor import JobEnded, OnEnded
from mart.trainer.jobs.job import ExitCode
from mart.trainer.jobs.job_files import why_ended

_AGAIN_S = 2.0  # between attempts to reach a head that is away
_LOOK_S = 2.0  # between looks whether it is there
_MISSES = 5  # in a row, and it is lost
_SOON_S = 0.5  # a head that is there answers
_CONNECT_S = 30.0  # a driver that began while the head was on its way never gets there


class RayExecutor:
    """Run jobs on a Ray cluster. For one thread.

    address: of the head, like 10.0.0.5:6379. log: what the driver prints.

    Raises InvalidInput for an address of another form.
    """

    def __init__(self, address: str, log: Path, ended: OnEnded) -> None:
        self._address = address
        self._head = _host_and_port(address)
        self._log = log
        self._ended = ended
        self._lock = threading.Lock()
        self._runs: dict[int, Path] = {}
        self._driver: subprocess.Popen[bytes] | None = None
        self._slots = 0
        self._not_before_s = 0.0

    @property
    def slots(self) -> int:
        """Count free places: 0 until a driver is connected; asking starts one, where the head answers."""
        if self._driver is None and clock.monotonic_s() >= self._not_before_s:
            if _answers(self._head, _SOON_S):
                self._connect()
            else:
                self._not_before_s = clock.monotonic_s() + _AGAIN_S
        return self._slots

    @property
    def trouble(self) -> str:
        return "" if self._slots else f"waits for the Ray cluster at {self._address}, which does not answer"

    def start(self, job: int, run: Path) -> None:
        with self._lock:
            has_driver = self._driver is not None
            self._runs[job] = run
        if has_driver:
            self._say(start=job, run=str(run))
        else:
            self._tell(job, ExitCode.LOST)

    def stop(self, job: int) -> None:
        self._say(stop=job)

    def close(self) -> None:
        driver = self._driver
        if driver is not None:
            assert driver.stdin is not None
            driver.stdin.close()
            stop_child(driver)

    def _connect(self) -> None:
        self._log.parent.mkdir(parents=True, exist_ok=True)
        command = (sys.executable, "-m", "mart.trainer.jobs.executors.ray_driver", self._address)
        with self._log.open("ab") as log:
            self._driver = start_child(
                command, log, {"RAY_gcs_rpc_server_reconnect_timeout_s": "5"}, piped=True
            )
        assert self._driver.stdout is not None
        for target, arguments in (
            (self._listen, (self._driver, self._driver.stdout)),
            (self._look, (self._driver,)),
        ):
            start_vital_thread(partial(target, *arguments), "ray")

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
                if said["code"] == ExitCode.LOST and not _answers(self._head, _LOOK_S):
                    driver.kill()
                    self._slots = 0
                self._tell(said["ended"], said["code"])
        driver.wait()
        self._slots = 0
        self._not_before_s = clock.monotonic_s() + _AGAIN_S
        with self._lock:
            self._driver = None
            lost = list(self._runs)
        for job in lost:
            self._tell(job, ExitCode.LOST)

    def _look(self, driver: subprocess.Popen[bytes]) -> None:
        misses = 0
        connected_by_s = clock.monotonic_s() + _CONNECT_S
        while not self._ended_within(driver, _LOOK_S):
            misses = 0 if _answers(self._head, _LOOK_S) else misses + 1
            if misses == _MISSES or (not self._slots and clock.monotonic_s() > connected_by_s):
                driver.kill()

    @staticmethod
    def _ended_within(driver: subprocess.Popen[bytes], timeout_s: float) -> bool:
        try:
            driver.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return False
        return True

    def _tell(self, job: int, code: int) -> None:
        with self._lock:
            run = self._runs.pop(job, None)
        if run is None:
            return
        if code == ExitCode.DONE:
            self._ended(JobEnded(job, code))
        elif code == ExitCode.LOST:
            self._ended(JobEnded(job, code, f"waits for the Ray cluster at {self._address}, which was lost"))
        else:
            self._ended(JobEnded(job, code, why_ended(run, code)))


def _host_and_port(address: str) -> tuple[str, int]:
    host, _, port = address.rpartition(":")
    if not host or "/" in host or not port.isdecimal() or int(port) >= 2**16:
        raise InvalidInput(
            f"The Ray address {address!r} was given; give the head's HOST:PORT, like 10.0.0.5:6379."
        )
    return host, int(port)


def _answers(head: tuple[str, int], timeout_s: float) -> bool:
    try:
        with socket.create_connection(head, timeout_s):
            return True
    except OSError:
        return False
