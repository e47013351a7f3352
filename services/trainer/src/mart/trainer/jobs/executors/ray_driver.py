"""Ray's side of the executor, in a process of its own: Ray ends its driver where the cluster's head is lost.

`python -m mart.trainer.jobs.executors.ray_driver ADDRESS`. Lines of JSON: in {"start": 7, "run": "/…/job-0007"} and
{"stop": 7}; out {"slots": 8} once it is connected and {"ended": 7, "code": 0}. It ends with its input.

Every job runs as `mart.trainer.jobs.worker` in a process of its own on a node of the cluster, which must have MART
installed and see the run's folder under the same path.
"""

from __future__ import annotations

import json
import logging
import os
import queue
import sys
import threading
from pathlib import Path
from typing import Any, TextIO

import ray

from mart.runtime.child_process import start_child
from mart.trainer.jobs.job import ExitCode
from mart.trainer.jobs.job_files import LOG

_POLL_S = 0.5


@ray.remote(num_cpus=1, max_retries=0, scheduling_strategy="SPREAD")
def _work(run: str) -> int:
    """Run a job on a node. Killing this task kills the job's process with it."""
    with (Path(run) / LOG).open("ab") as log:
        process = start_child((sys.executable, "-m", "mart.trainer.jobs.worker", run), log, {})
    return process.wait()


class _Tasks:
    """Tasks that are not over."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._jobs: dict[ray.ObjectRef[int], int] = {}

    def handle(self, request: dict[str, Any]) -> None:
        if "start" in request:
            self._jobs[_work.remote(request["run"])] = request["start"]
        else:
            for task, job in self._jobs.items():
                if job == request["stop"]:
                    ray.cancel(task, force=True)

    def tell_ended(self) -> None:
        ended, _ = (
            ray.wait(list(self._jobs), num_returns=len(self._jobs), timeout=0) if self._jobs else ([], [])
        )
        for task in ended:
            _tell(self._stream, ended=self._jobs.pop(task), code=_code(task))


def _code(task: ray.ObjectRef[int]) -> int:
    try:
        code: int = ray.get(task)
    except (ray.exceptions.TaskCancelledError, ray.exceptions.WorkerCrashedError):
        return ExitCode.STOPPED
    except ray.exceptions.RayError:
        return ExitCode.LOST
    return code


def _cluster_resources() -> dict[str, float]:
    found: dict[str, float] = ray.cluster_resources()  # type: ignore[no-untyped-call]
    return found


def _take_stdout() -> TextIO:
    """Standard output for our lines alone; what Ray prints there (at times a node's death) goes to standard error."""
    stream = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1)
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    return stream


def _tell(stream: TextIO, **fields: int) -> None:
    stream.write(json.dumps(fields) + "\n")


def _read_requests(requests: queue.SimpleQueue[dict[str, Any] | None]) -> None:
    for line in sys.stdin:
        requests.put(json.loads(line))
    requests.put(None)


def main() -> None:
    stream = _take_stdout()
    ray.init(address=sys.argv[1], log_to_driver=False, logging_level=logging.ERROR, namespace="mart")
    _tell(stream, slots=max(1, int(_cluster_resources().get("CPU", 1))))
    requests: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
    threading.Thread(target=_read_requests, args=(requests,), daemon=True).start()
    tasks = _Tasks(stream)
    while True:
        try:
            request = requests.get(timeout=_POLL_S)
            if request is None:
                return
            tasks.handle(request)
        except queue.Empty:
            tasks.tell_ended()


if __name__ == "__main__":
    main()
