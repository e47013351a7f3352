"""Put jobs and policies into words for people, and into plain data."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from google.protobuf.json_format import MessageToDict
from google.protobuf.message import Message

from mart.protocol.messages import Job, Learned, Policy, TrainerReply, job_state_word

_HEAD = ("job", "sweep", "state", "model", "task", "data set", "seeds", "updates", "best")


def as_json(message: Message) -> dict[str, Any]:
    """Return a message as plain data, empty fields included."""
    return MessageToDict(message, preserving_proto_field_name=True, always_print_fields_with_no_presence=True)


def table(jobs: Iterable[Job]) -> str:
    """Return jobs as a table, a row each."""
    rows = [_HEAD, *(_row(job) for job in jobs)]
    if len(rows) == 1:
        return "There are no jobs. `mart jobs submit` makes some."
    widths = [max(len(row[column]) for row in rows) for column in range(len(_HEAD))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


def details(found: TrainerReply.Details) -> str:
    """Return what is known of one job, in lines."""
    job = found.job
    lines = [table([job])]
    if job.detail:
        lines += ["", job.detail]
    if found.HasField("learned"):
        lines += ["", learned(found.learned)]
    lines += ["", *(_evaluated(evaluation) for evaluation in found.evaluations)]
    return "\n".join(lines).rstrip()


def learned(found: Learned) -> str:
    """What a run learned from, and what of a data set it did not."""
    whole = f" of the {found.dataset_episodes} in {found.dataset}" if found.dataset else ""
    ticks = f"{found.ticks} ticks of {found.control_hz:g} Hz"
    text = f"Episodes learned from: {found.episodes}{whole}; {ticks}, digest {found.sha256[:12]}."
    return f"{text} Left out: {', '.join(found.left_out)}." if found.left_out else text


def policy(found: Policy) -> str:
    """Return a policy in one line."""
    return f"{found.name}: {found.model} for {found.task}, seed {found.seed}, {found.updates} updates"


def _row(job: Job) -> tuple[str, ...]:
    progress, order = job.progress, job.order
    return (
        job.id,
        job.sweep,
        job_state_word(job.state),
        order.model,
        order.task,
        order.dataset or "–",
        str(len(order.seeds)),
        f"{progress.updates} of {progress.updates_in_all}",
        "–" if progress.best_success < 0 else f"{100 * progress.best_success:.0f} %",
    )


def _evaluated(found: Any) -> str:
    rate = 100 * found.successes / max(1, found.episodes)
    interval = f"{100 * found.low:.0f}–{100 * found.high:.0f}"
    return f"seed {found.seed}, {found.updates} updates, {found.purpose}: {rate:.1f} % ({interval})"
