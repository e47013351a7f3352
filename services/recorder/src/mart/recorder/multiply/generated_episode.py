"""Write what was played as an episode file like any other, marked as generated: verified, read back, then named."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mart.episodes.mcap_entries import state_entries
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.errors import Corrupt
from mart.protocol.messages import OPERATOR_GENERATED, Model
from mart.protocol.recording import (
    PART_SUFFIX,
    VERSIONS,
    CadenceRecord,
    EpisodeRecord,
    GeneratedRecord,
    OperatorsRecord,
    RoomRecord,
    Shift,
    VerificationRecord,
)
from mart.protocol.tasks import Task
from mart.protocol.vocabulary import EpisodeEndedBy, EpisodeOutcome, OperatorKind, Verdict
from mart.recorder.importing.episode_states import StateRows, states_of
from mart.recorder.multiply.composition import WayPiece
from mart.recorder.multiply.references import Reference
from mart.recorder.multiply.replay import PlayedWorld
from mart.recorder.multiply.segments import SegmentKind
from mart.recorder.record.finalize import VerifyFile, below, free_path, versions

ROOM, MODE = "multiply", "generated"


@dataclass(frozen=True)
class EpisodeMaker:
    """Write generated episodes of one task into a folder. model: what its worlds are compiled to."""

    out: Path
    task: Task
    control_hz: float
    model: Model
    references: Mapping[SegmentKind, Reference]
    verify: VerifyFile

    def write(self, played: PlayedWorld, made: GeneratedRecord, now_ns: int) -> Path:
        """Write an episode and return its path; now_ns: Unix time, of its first state.

        Raises Corrupt where it is not verified: then no file is left.
        """
        rows = self._rows(played, now_ns)
        record = self._record(rows, played, made)
        file = EpisodeWriter(free_path(self.out, record, PART_SUFFIX))
        try:
            self._fill(file, rows, record, made, now_ns)
            file.finish()
            EpisodeFile.open(file.path).check(file.messages)
            below(self.out)(file, record)
        except BaseException:
            with contextlib.suppress(FileNotFoundError):
                file.discard()
            raise
        return file.path

    def made_of(self, played: PlayedWorld, attempt: int, seed: int, sources_sha256: str) -> GeneratedRecord:
        """Tell of what an attempt was made."""
        pieces = [piece for own in played.pieces.values() for piece in own]
        sources = tuple(dict.fromkeys(piece.demonstration.name for piece in pieces))
        return GeneratedRecord(
            attempt=attempt,
            seed=seed,
            sources_sha256=sources_sha256,
            sources=sources,
            segments={arm: self._segments(own, sources) for arm, own in played.pieces.items()},
        )

    def _segments(self, pieces: Sequence[WayPiece], sources: Sequence[str]) -> str:
        return " ".join(
            f"{sources.index(piece.demonstration.name)}:{one.begin}-{one.end}@{_word(self.references[one.kind])}"
            for piece in pieces
            for one in piece.segments
        )

    def _fill(
        self, file: EpisodeWriter, rows: StateRows, record: EpisodeRecord, made: GeneratedRecord, now_ns: int
    ) -> None:
        room = RoomRecord(
            room=ROOM,
            task=self.task.name,
            control_hz=self.control_hz,
            model_sha256=self.model.sha256,
            mujoco_version=self.model.mujoco_version,
            arm_kinds=self.task.arm_kinds,
        ).with_numerics(self.model.numerics)
        file.describe(room)
        file.attach_model(self.model, now_ns)
        for state in states_of(rows, ROOM, record.number):
            sent_ns = state.stamps.sent_ns
            for entry in state_entries(state, codec.encode(state), sent_ns, record.task, record.arm_kinds):
                file.add(entry)
        file.flush()
        verification = self.verify(EpisodeFile(file.path, {}), room)
        _require_verified(verification)
        time_s = record.ticks / self.control_hz
        shift = Shift(episode_tick=0, operator=OperatorKind.GENERATED)
        for known in (
            record,
            CadenceRecord(wall_s=time_s, sim_s=time_s, missing_ticks=0, waited_s=0.0),
            OperatorsRecord(shifts=dict.fromkeys(self.task.arm_names, (shift,))),
            verification,
            made,
        ):
            file.add_record(known.NAME, known.to_strings())
        file.add_record(VERSIONS, versions())

    def _record(self, rows: StateRows, played: PlayedWorld, made: GeneratedRecord) -> EpisodeRecord:
        return EpisodeRecord(
            room=ROOM,
            number=made.attempt + 1,
            task=self.task.name,
            control_hz=self.control_hz,
            arms=self.task.arm_names,
            arm_kinds=self.task.arm_kinds,
            seed=played.seed,
            mode=MODE,
            started_ns=int(rows.sent_ns[0]),
            ended_ns=int(rows.sent_ns[-1]),
            ticks=len(rows) - 1,
            first_tick=0,
            last_tick=len(rows) - 1,
            outcome=EpisodeOutcome.SUCCESS,
            reason="the task is done",
            ended_by=EpisodeEndedBy.TASK,
            subtasks_done=int(played.subtasks[-1].sum()),
            subtasks=len(self.task.subtasks),
            interrupted=False,
            complete=True,
        )

    def _rows(self, played: PlayedWorld, started_ns: int) -> StateRows:
        """Return the states of what was played. Nobody waited: the stamps are those of real time."""
        ticks, arms = len(played.actions), self.task.arm_names
        success = np.zeros(ticks + 1, np.bool_)
        success[-1] = played.succeeded
        return StateRows(
            arms=arms,
            observations=played.observations,
            actions=played.actions,
            sources=np.full((ticks, len(arms)), OPERATOR_GENERATED, np.int64),
            engaged=np.ones((ticks, len(arms)), np.bool_),
            ticks=np.arange(ticks + 1),
            success=success,
            subtasks={one.name: played.subtasks[:, i] for i, one in enumerate(self.task.subtasks)},
            sim_time_s=played.sim_time_s,
            sent_ns=started_ns + np.rint(np.arange(ticks + 1) / self.control_hz * 1e9).astype(np.int64),
            positions=self._tools(played, "tool_position_in_base"),
            quaternions=self._tools(played, "tool_quaternion_in_base"),
            states=played.integration_states,
        )

    def _tools(self, played: PlayedWorld, what: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        return np.stack([played.observations[f"{arm}/{what}"] for arm in self.task.arm_names], axis=1)


def _word(reference: Reference) -> str:
    return reference.frame.removeprefix("the ")


def _require_verified(verification: VerificationRecord) -> None:
    if verification.verdict is not Verdict.VERIFIED:
        raise Corrupt(
            f"A generated episode was stepped again and is {verification.verdict.value}: {verification.detail} "
            "Replicas of one version and one kind of processor are needed."
        )
