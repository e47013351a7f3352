"""Put together what a multiplication takes: sources, replicas, worlds, files."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mart.recorder.multiply.composition import Composer
from mart.recorder.multiply.generated_episode import EpisodeMaker
from mart.recorder.multiply.multiplication import Batch, Multiplication, digest_of
from mart.recorder.multiply.references import references_of
from mart.recorder.multiply.replay import Replayer
from mart.recorder.multiply.sources import Sources, read_sources
from mart.recorder.verify.replica import replica
from mart.recorder.verify.resimulation import verify
from mart.rollouts.client import RolloutClient
from mart.rollouts.replicas import reached_replicas


@dataclass(frozen=True)
class MultiplyOrder:
    """Say what to multiply. replicas: none named: one is started for it."""

    paths: tuple[Path, ...]
    task: str
    wanted: int
    out: Path
    seed: int = 0
    first: int | None = None
    operator: str = ""
    from_generated: bool = False
    replicas: tuple[str, ...] = ()


@contextlib.contextmanager
def multiplying(order: MultiplyOrder) -> Iterator[tuple[Sources, Iterator[Batch]]]:
    """Give the sources and the batches as they come. Raises as `read_sources` and `reached_replicas`."""
    sources = read_sources(
        order.paths, order.task, order.first, from_generated=order.from_generated, operator=order.operator
    )
    task, control_hz = sources.task, sources.control_hz
    composer = Composer(task, sources.demonstrations)
    references = references_of(composer.segments())
    with (
        reached_replicas(order.replicas) as (bus, names),
        contextlib.closing(RolloutClient(bus, names)) as client,
    ):
        ask = replica(bus, names[0])
        maker = EpisodeMaker(
            out=order.out,
            task=task,
            control_hz=control_hz,
            model=client.model(task.name, control_hz, len(task.arms), task.arm_kinds),
            references=references,
            verify=lambda file, room: verify(file, room, ask),
        )
        replayer = Replayer(client, task, control_hz, composer, references, task.trial_limit_s)
        digest = digest_of(task.name, sources.demonstrations)
        yield sources, Multiplication(replayer, maker, digest, order.seed, order.wanted).run()
