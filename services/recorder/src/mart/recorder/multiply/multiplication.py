"""Multiply demonstrations: attempt after attempt, a batch at a time, until enough have succeeded.

The seed and an attempt's number decide everything, so that one that was killed goes on where it was: what was tried is
a line of `multiply.jsonl` beside the episodes, and an episode that was written before its line is found by its number.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mart.episodes.folder import files_below
from mart.episodes.reader import EpisodeFile
from mart.protocol import clock
from mart.protocol.errors import Conflict, Corrupt, InvalidInput
from mart.protocol.recording import GeneratedRecord
from mart.recorder.multiply.demonstration import Demonstration
from mart.recorder.multiply.generated_episode import EpisodeMaker
from mart.recorder.multiply.replay import PlayedWorld, Replayer
from mart.runtime.json_lines import append_json_line, read_json_lines

LOG = "multiply.jsonl"
_BATCH = 32  # worlds at most: a tick of them costs little more a world than one of many more
_FEWEST_KEPT_OF = 256  # attempts of which none succeeded are enough
_SEEDS = 2**32


@dataclass(frozen=True)
class Batch:
    """Tell of one batch: attempts from `first` on, and the files of those that were kept."""

    first: int
    attempts: int
    kept: tuple[str, ...]


@dataclass(frozen=True)
class Multiplication:
    """Make episodes of demonstrations until `wanted` have been kept. seed: decides worlds and choices."""

    replayer: Replayer
    maker: EpisodeMaker
    sources_sha256: str
    seed: int
    wanted: int

    def run(self) -> Iterator[Batch]:
        """Yield each batch once its episodes are on the disk, those of earlier runs first.

        Raises Conflict where the folder holds what was made of other demonstrations, InvalidInput where nothing
        succeeds.
        """
        kept = attempts = 0
        for batch in self._earlier():
            kept, attempts = kept + len(batch.kept), batch.first + batch.attempts
            yield batch
        written = self._written()
        while kept < self.wanted:
            batch = self._batch(attempts, self.wanted - kept, written)
            kept, attempts = kept + len(batch.kept), attempts + batch.attempts
            self._note(batch)
            yield batch
            if not kept and attempts >= _FEWEST_KEPT_OF:
                raise InvalidInput(
                    f"None of {attempts} attempts did the task: these demonstrations cannot be carried to other "
                    "worlds. Give more of them, or some without second tries."
                )

    def _batch(self, first: int, most: int, written: dict[int, str]) -> Batch:
        attempts = range(first, first + min(_BATCH, most + most // 4 + 1))  # some may fail
        kept: list[str] = []
        for attempt, played in zip(attempts, self._play(attempts), strict=True):
            if len(kept) == most:
                return Batch(first, attempt - first, tuple(kept))
            if played.succeeded:
                kept.append(written.get(attempt) or self._write(attempt, played))
        return Batch(first, len(attempts), tuple(kept))

    def _play(self, attempts: Sequence[int]) -> list[PlayedWorld]:
        return self.replayer.play([world_seed(self.seed, attempt) for attempt in attempts])

    def _write(self, attempt: int, played: PlayedWorld) -> str:
        made = self.maker.made_of(played, attempt, self.seed, self.sources_sha256)
        path = self.maker.write(played, made, clock.wall_ns())
        return path.relative_to(self.maker.out).as_posix()

    def _note(self, batch: Batch) -> None:
        append_json_line(
            self.maker.out / LOG, {"sources": self.sources_sha256, "seed": self.seed, **vars(batch)}
        )

    def _earlier(self) -> Iterator[Batch]:
        """Yield what earlier runs have noted, without a gap."""
        path, expected = self.maker.out / LOG, 0
        for number, row in read_json_lines(path):
            if row is None:
                continue  # torn by a kill: the batch is played again
            if (row.get("sources"), row.get("seed")) != (self.sources_sha256, self.seed):
                raise Conflict(
                    f"{self.maker.out} holds episodes that were made of other demonstrations or with another seed; "
                    "name another folder with --out."
                )
            try:
                batch = Batch(int(row["first"]), int(row["attempts"]), tuple(map(str, row["kept"])))
            except (KeyError, TypeError, ValueError) as error:
                raise Corrupt(
                    f"Line {number} of {path} is none of `mart multiply`; name another folder."
                ) from error
            if batch.first == expected:
                expected += batch.attempts
                yield batch

    def _written(self) -> dict[int, str]:
        """Return the episodes that are there, by the numbers of their attempts."""
        found = {}
        for path in files_below(self.maker.out) if self.maker.out.is_dir() else ():
            strings = EpisodeFile.open(path).metadata.get(GeneratedRecord.NAME)
            made = GeneratedRecord.from_strings(strings) if strings else None
            if made and (made.sources_sha256, made.seed) == (self.sources_sha256, self.seed):
                found[made.attempt] = path.relative_to(self.maker.out).as_posix()
        return found


def world_seed(seed: int, attempt: int) -> int:
    """Return the seed of an attempt's world."""
    return int(np.random.default_rng([seed, attempt]).integers(_SEEDS))


def digest_of(task: str, demonstrations: Sequence[Demonstration]) -> str:
    """Return the SHA-256 of a task and of what its demonstrations did, whatever their files are called."""
    digest = hashlib.sha256(task.encode())
    for one in demonstrations:
        for arm, way in sorted(one.ways.items()):
            digest.update(arm.encode())
            digest.update(way.positions.tobytes() + way.grippers.tobytes())
    return digest.hexdigest()
