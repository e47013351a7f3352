"""Load a checkpoint as the policy that it is."""

from __future__ import annotations

from pathlib import Path

from mart.protocol.errors import Corrupt, MartError
from mart.trainer.data.layout import ObservationField, ObservationLayout
from mart.trainer.models.checkpoint import CheckpointRecord, read_record, read_weights
from mart.trainer.models.devices import find_device
from mart.trainer.models.networks import Networks
from mart.trainer.models.policies.chunked import ChunkedPolicy
from mart.trainer.models.policies.hierarchical import HierarchicalPolicy
from mart.trainer.models.policies.trained import TrainedPolicy


def load_policy(checkpoint: Path, device: str = "cpu") -> TrainedPolicy:
    """Load the policy of one checkpoint directory.

    Raises NotFound where there is none; Corrupt where it is damaged, of another format, or of a task that this version
    knows otherwise; Unavailable where the device is not there.
    """
    where = find_device(device)
    record = read_record(checkpoint)
    _check_task(checkpoint, record)
    layout = ObservationLayout(record.arms, record.layout)
    networks = Networks(record.model, layout, record.hyperparameters, [record.seed])
    try:
        networks.load_state_dict(read_weights(checkpoint))
    except RuntimeError as error:
        raise Corrupt(
            f"{checkpoint} holds weights that are not those of its {record.name}; train again."
        ) from error
    networks.to(where).eval()
    kind = ChunkedPolicy if record.model.is_chunked else HierarchicalPolicy
    return kind(record, networks, where)


def _check_task(checkpoint: Path, record: CheckpointRecord) -> None:
    """Raise Corrupt where what was learned would not mean the same now."""
    try:
        known = ObservationLayout.of_arms(record.task, len(record.arms), record.arm_kinds)
    except MartError as error:
        raise Corrupt(f"{checkpoint} is of the task {record.task}. {error}") from error
    now: tuple[ObservationField, ...] = known.fields
    if now != record.layout:
        changed = next(
            (a or b for a, b in zip((*record.layout, None), (*now, None), strict=False) if a != b), None
        )
        raise Corrupt(
            f"{checkpoint} was trained when {record.task} had other observations "
            f"({changed.name if changed else 'more or fewer'} differs); train again."
        )
