"""Give checkpoints names: folders below `policies`, complete before they have their name."""

from __future__ import annotations

import logging
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

from google.protobuf.json_format import MessageToJson, Parse, ParseError

from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.messages import Policy
from mart.runtime.atomic_directory import write_directory_atomically
from mart.trainer.evaluate.evaluation import Evaluation
from mart.trainer.jobs.service.serialization import evaluation_message
from mart.trainer.models.checkpoint import RECORD, WEIGHTS, CheckpointRecord, read_record

_log = logging.getLogger(__name__)

FILE = "policy.json"
_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


@dataclass(frozen=True)
class Origin:
    """Tell where a checkpoint comes from, and what is known of it."""

    job: str
    evaluation: Evaluation | None


def promote(policies_dir: Path, name: str, checkpoint: Path, origin: Origin, now_ns: int) -> Policy:
    """Copy a checkpoint to a named policy and return it.

    Raises InvalidInput for the name, Conflict where it is taken, and what reading a checkpoint raises.
    """
    if not _NAME.fullmatch(name):
        raise InvalidInput(
            f"The policy name {name!r} was given; use 1 to 64 lower-case letters, digits, '-' or '_', starting "
            "with a letter or digit."
        )
    folder = policies_dir / name
    if folder.exists():
        raise Conflict(f"There is a policy {name!r} already; withdraw it or choose another name.")
    policy = _policy(name, read_record(checkpoint), origin.job, now_ns)
    if origin.evaluation is not None:
        policy.evaluation.CopyFrom(evaluation_message(origin.evaluation))
    files = {file: (checkpoint / file).read_bytes() for file in (RECORD, WEIGHTS)}
    policies_dir.mkdir(parents=True, exist_ok=True)
    write_directory_atomically(
        folder, files | {FILE: MessageToJson(policy, preserving_proto_field_name=True).encode()}
    )
    return policy


def policies(policies_dir: Path, task: str = "") -> list[Policy]:
    """Return the policies of this task, or of all tasks, the newest first.

    One whose record is damaged is left out, and a warning says so; `withdraw` removes it too.
    """
    found = filter(None, map(_read, policies_dir.glob(f"*/{FILE}")))
    chosen = [policy for policy in found if task in ("", policy.task)]
    return sorted(chosen, key=lambda policy: policy.promoted_ns, reverse=True)


def withdraw(policies_dir: Path, name: str) -> Policy:
    """Remove a policy and return it; a seat that it drives already goes on. Raises NotFound."""
    known = {path.parent.name: path for path in policies_dir.glob(f"*/{FILE}")}
    if name not in known:
        raise NotFound.named("policy", name, known)
    removed = _read(known[name]) or Policy(name=name)
    gone = policies_dir / f".{name}.withdrawn"
    shutil.rmtree(gone, ignore_errors=True)
    (policies_dir / name).rename(gone)
    shutil.rmtree(gone)
    return removed


def _policy(name: str, record: CheckpointRecord, job: str, now_ns: int) -> Policy:
    model = record.model
    return Policy(
        name=name,
        model=record.name,
        task=record.task,
        control_hz=record.control_hz,
        arms=record.arms,
        arm_kinds=record.arm_kinds,
        joint="joint" in (model.actor, model.residual, model.planner),
        seed=record.seed,
        updates=record.updates,
        job=job,
        promoted_ns=now_ns,
    )


def _read(path: Path) -> Policy | None:
    """Return what a record says; None where it cannot be read."""
    try:
        policy = Parse(path.read_bytes(), Policy())
    except (OSError, ParseError, ValueError, RecursionError) as error:
        _log.warning("%s cannot be read (%s); withdraw the policy and promote it again.", path, error)
        return None
    return policy if policy.task else None
