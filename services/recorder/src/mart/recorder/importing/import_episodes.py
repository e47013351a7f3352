"""Make an episode file of each foreign episode: written aside, read back, then named; nothing is ever overwritten."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from mart.episodes.folder import episode_files
from mart.episodes.mcap_entries import state_entries
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.errors import Conflict, Corrupt, InvalidInput, MartError, NotFound
from mart.protocol.messages import Model
from mart.protocol.recording import (
    PART_SUFFIX,
    VERSIONS,
    CadenceRecord,
    EpisodeRecord,
    RoomRecord,
    VerificationRecord,
)
from mart.protocol.tasks import Task, is_in_catalogue, recorded_task
from mart.protocol.vocabulary import Verdict
from mart.recorder.importing.episode_records import (
    ORIGIN,
    episode_record,
    is_at_another_rate,
    operators_record,
    origin_record,
    room_of,
    room_record,
)
from mart.recorder.importing.episode_states import StateRows, rows_of_task, rows_to_look_at, states_of
from mart.recorder.importing.foreign_episode import ForeignEpisode, NotImported, Setting
from mart.recorder.importing.setting import task_of
from mart.recorder.record.finalize import VerifyFile, below, free_path, versions

_FLUSH_EVERY = 200  # states


@dataclass(frozen=True)
class Imported:
    """Tell of an episode that was written. left_out: what of it is not there, in sentences."""

    path: Path
    name: str
    task: str | None
    ticks: int
    verdict: str
    detail: str
    left_out: tuple[str, ...]


@dataclass(frozen=True)
class ImportOrder:
    """Say how to import. wanted_task: of what task episodes are whose data set names none; None: to look at only.

    now_ns, started_ns: Unix time of the import, and of the source, from which episodes without stamps are dated.
    """

    source: Path
    file_format: str
    out: Path
    setting: Setting
    wanted_task: str | None
    verify: VerifyFile
    now_ns: int
    started_ns: int


def import_all(
    order: ImportOrder, episodes: Iterable[ForeignEpisode | NotImported]
) -> Iterator[Imported | NotImported]:
    """Import one after another; one that cannot be, or is there already, is told of instead.

    Raises Conflict where the folder cannot be written.
    """
    there = _there_already(order.out)
    for episode in episodes:
        if isinstance(episode, NotImported):
            yield episode
        elif (episode.source_sha256, episode.name) in there:
            yield NotImported(
                episode.name, f"it is there already: {there[episode.source_sha256, episode.name]}."
            )
        else:
            yield _imported(order, episode)


def _imported(order: ImportOrder, episode: ForeignEpisode) -> Imported | NotImported:
    try:
        return _import(order, episode)
    except (InvalidInput, Corrupt, NotFound) as error:
        sentence = str(error)
        return NotImported(episode.name, sentence if sentence.endswith(".") else f"{sentence}.")
    except OSError as error:
        raise Conflict(f"{order.out} cannot be written: {error}.") from error


def _import(order: ImportOrder, episode: ForeignEpisode) -> Imported:
    task = _task(order, episode)
    rate = order.setting.control_hz
    rows = (
        rows_to_look_at(episode, rate, order.started_ns)
        if task is None
        else rows_of_task(episode, task, rate, order.started_ns)
    )
    room = room_of(order.source.name)
    record = episode_record(episode, rows, task, rate, room)
    follows = rows.states is not None and not is_at_another_rate(episode, rate)
    described = room_record(episode, task, rate if follows else None, room)
    file = EpisodeWriter(free_path(order.out, record, PART_SUFFIX))
    try:
        verification = _write(file, order, episode, rows, (record, described))
        file.finish()
        read = EpisodeFile.open(file.path)
        read.check(file.messages)
        read.arrays(task)
        below(order.out)(file, record)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            file.discard()
        raise
    return Imported(
        file.path,
        episode.name,
        record.task,
        record.ticks,
        verification.verdict.value,
        verification.detail,
        episode.left_out,
    )


def _write(
    file: EpisodeWriter,
    order: ImportOrder,
    episode: ForeignEpisode,
    rows: StateRows,
    records: tuple[EpisodeRecord, RoomRecord],
) -> VerificationRecord:
    record, room = records
    file.describe(room)
    model = _model(episode, room)
    if model is not None:
        file.attach_model(model, order.now_ns)
    for number, state in enumerate(states_of(rows, record.room, record.number)):
        sent_ns, payload = state.stamps.sent_ns, codec.encode(state)
        entries = state_entries(state, payload, sent_ns, record.task, record.arm_kinds)
        for entry in entries if rows.arms else entries[:1]:
            file.add(entry)
        if number % _FLUSH_EVERY == 0:
            file.flush()
    file.flush()
    verification = _verified(file, order, episode, room, rows)
    cadence = CadenceRecord(
        wall_s=(record.ended_ns - record.started_ns) / 1e9,
        sim_s=float(rows.sim_time_s[-1] - rows.sim_time_s[0]),
        missing_ticks=0,
        waited_s=0.0,
    )
    for known in (record, cadence, operators_record(episode, rows), verification):
        file.add_record(known.NAME, known.to_strings())
    file.add_record(ORIGIN, origin_record(episode, order.file_format, order.now_ns))
    file.add_record(VERSIONS, versions())
    return verification


def _verified(
    file: EpisodeWriter, order: ImportOrder, episode: ForeignEpisode, room: RoomRecord, rows: StateRows
) -> VerificationRecord:
    """Have it stepped again where it can be; say why not where it cannot."""
    if rows.measured or (rows.states is not None and room.model_sha256 and room.control_hz):
        return order.verify(EpisodeFile(file.path, {}), room)
    why = "it holds no integration states, or not the model that they are of"
    if rows.states is not None and room.model_sha256:
        why = "it was told at another rate than it was recorded at"
    return VerificationRecord(
        verdict=Verdict.UNVERIFIED,
        detail=f"Imported from {episode.source_file}; it cannot be stepped again: {why}.",
        pending=False,
    )


def _model(episode: ForeignEpisode, room: RoomRecord) -> Model | None:
    """Return the model that an export of ours carries. Raises Corrupt where it is another than the recorded one."""
    mjb = None if episode.origin is None else episode.origin.mjb
    if mjb is None or not room.model_sha256:
        return None
    if sha256(mjb).hexdigest() != room.model_sha256:
        raise Corrupt("the model in its file is not the one whose SHA-256 it names.")
    assert episode.origin is not None
    return Model(mjb=mjb, sha256=room.model_sha256, task_file=episode.origin.task_file or b"")


def _task(order: ImportOrder, episode: ForeignEpisode) -> Task | None:
    """Return the task: of an export of ours the recorded one, as its own task file says it where it has one."""
    origin = episode.origin
    strings = {} if origin is None else origin.records.get(EpisodeRecord.NAME, {})
    if origin is None or not strings:
        return task_of(order.setting, order.wanted_task, episode.actions.shape[1])
    recorded = EpisodeRecord.from_strings(strings)
    name = recorded.task or ""
    if origin.task_file is not None and not is_in_catalogue(name):
        return recorded_task(name, origin.task_file, recorded.arm_kinds)
    known = Setting(name, len(recorded.arms), recorded.arm_kinds)
    return task_of(known, None, episode.actions.shape[1])


def _there_already(out: Path) -> dict[tuple[str, str], Path]:
    """Return what is in a folder by the digest and the demonstration that it was imported from."""
    found: dict[tuple[str, str], Path] = {}
    for path in episode_files([out]) if out.is_dir() else ():
        with contextlib.suppress(MartError):
            origin = EpisodeFile.open(path).metadata.get(ORIGIN, {})
            if origin:
                found[origin.get("sha256", ""), origin.get("episode", "")] = path
    return found
