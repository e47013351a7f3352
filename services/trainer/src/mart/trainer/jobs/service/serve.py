"""`mart trainer`: the queue and the handlers of requests, put together."""

from __future__ import annotations

import contextlib
import fcntl
from collections.abc import Iterator

from mart.protocol import clock, keys
from mart.protocol.errors import Conflict
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.service import announced, connected
from mart.trainer.jobs.executors.executor import Executor, JobEnded, OnEnded
from mart.trainer.jobs.executors.local import LocalExecutor
from mart.trainer.jobs.executors.ray import RayExecutor
from mart.trainer.jobs.queue import JobQueue
from mart.trainer.jobs.service.handlers import TrainerHandlers
from mart.trainer.jobs.service.request_server import Inbox, RequestServer
from mart.trainer.jobs.service.settings import TrainerSettings
from mart.trainer.jobs.service.trainer_metrics import show_jobs
from mart.trainer.jobs.service.videos import Videos
from mart.trainer.jobs.table import JobTable

_MAX_WAITING = 256
_LONGEST_WAIT_S = 0.5  # so that a stop is noticed, and a cluster that is back


def serve_trainer(settings: TrainerSettings) -> None:
    """Serve until the process is asked to stop; jobs that run then are gone on with by the next trainer."""
    inbox = Inbox(_MAX_WAITING)
    with contextlib.ExitStack() as stack:
        service = stack.enter_context(connected(settings, ServiceKind.TRAINER, settings.trainer))
        stack.enter_context(_claimed(settings))
        table = stack.enter_context(contextlib.closing(JobTable(settings.jobs_path)))
        executors = stack.enter_context(_executors(settings, inbox.put_always))
        jobs = JobQueue(table, executors, settings.data_dir, clock.wall_ns())
        videos = stack.enter_context(contextlib.closing(Videos(settings.data_dir / "logs" / "render.log")))
        handlers = TrainerHandlers(
            settings, table, jobs, videos, executors=list(executors), now_ns=clock.wall_ns
        )
        server = stack.enter_context(contextlib.closing(RequestServer(handlers, inbox)))
        topic = keys.training(settings.trainer)
        stack.enter_context(contextlib.closing(service.bus.serve(topic, inbox.put)))
        stack.enter_context(announced(service))
        while not service.stop.is_set():
            jobs.advance(clock.wall_ns())
            show_jobs(table.counts())
            item = inbox.take(_LONGEST_WAIT_S)
            if isinstance(item, JobEnded):
                jobs.end(item, clock.wall_ns())
            elif callable(item):
                item()
            elif item is not None:
                server.take(item)


@contextlib.contextmanager
def _claimed(settings: TrainerSettings) -> Iterator[None]:
    """Let one trainer at a time see to the jobs, or each would start the other's jobs.

    The lock dies with its process.
    """
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    with settings.jobs_path.with_suffix(".lock").open("ab") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise Conflict(
                f"The jobs in {settings.data_dir} are seen to by another trainer; stop it, or set MART_DATA_DIR."
            ) from error
        yield


@contextlib.contextmanager
def _executors(settings: TrainerSettings, ended: OnEnded) -> Iterator[dict[str, Executor]]:
    with contextlib.ExitStack() as stack:
        executors: dict[str, Executor] = {
            "local": stack.enter_context(contextlib.closing(LocalExecutor(settings.slots, ended)))
        }
        if settings.ray:
            ray = RayExecutor(settings.ray, settings.data_dir / "logs" / "ray.log", ended)
            executors["ray"] = stack.enter_context(contextlib.closing(ray))
        yield executors
