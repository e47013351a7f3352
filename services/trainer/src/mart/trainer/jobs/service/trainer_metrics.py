"""Show how a trainer's jobs stand."""

from __future__ import annotations

from collections.abc import Mapping

from prometheus_client import Gauge

from mart.runtime.metrics import REGISTRY
from mart.trainer.jobs.job import JobState

JOBS = Gauge(
    "mart_trainer_jobs", "Jobs that were ever submitted, by their state.", ("state",), registry=REGISTRY
)


def show_jobs(counts: Mapping[JobState, int]) -> None:
    """Take how many jobs are in each state."""
    for state, count in counts.items():
        JOBS.labels(state).set(count)
