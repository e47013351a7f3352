"""Read one episode file: its metadata at once, its messages one by one. Also a `.part`, as far as it goes."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData, arrays_of
from mart.episodes.contents import read_attachments, read_messages, read_metadata, require_intact_data
from mart.episodes.foreign import foreign_kind
from mart.episodes.resampling import at_control_hz
from mart.episodes.scan import BoundedFile, ForeignFile, corruption
from mart.episodes.steady_time import SteadyTime
from mart.episodes.summary import read_summary
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import State
from mart.protocol.recording import (
    MODEL_ATTACHMENT,
    STATE,
    SUFFIX,
    TASK_ATTACHMENT,
    VERSIONS,
    CadenceRecord,
    EpisodeRecord,
    OperatorsRecord,
    RoomRecord,
    VerificationRecord,
)
from mart.protocol.tasks import Task, get_task, is_in_catalogue, recorded_task

_DISTRIBUTION = (
    "mart-episodes"  # whose version a file was written by; before it was one of its own, the recorder's
)


R = TypeVar("R", EpisodeRecord, CadenceRecord, OperatorsRecord, VerificationRecord, RoomRecord)


@dataclass(frozen=True)
class RecordedMessage:
    """Hold one message of a file: its topic, its bytes and its stamps (Unix time, nanoseconds)."""

    topic: str
    payload: bytes
    arrived_ns: int
    sent_ns: int
    sequence: int


def open_episode(path: Path | str) -> EpisodeFile:
    """Open an episode file for reading.

    Raises NotFound where there is no file and Corrupt where it is no episode or is damaged.

        >>> episode = open_episode("data/episodes/2026-11-22/room-1-0001-two_arm_multi_cube_lifting.mcap")
        >>> episode.episode.outcome
        'success'
        >>> episode.arrays().actions.shape
        (412, 2, 7)
    """
    return EpisodeFile.open(Path(path))


@dataclass(frozen=True)
class EpisodeFile:
    """Read an episode file. Each question opens the file and closes it again; whatever cannot be trusted is Corrupt.

    metadata: the file's metadata records, by name, as strings; the properties read them as typed records.
    """

    path: Path
    metadata: Mapping[str, Mapping[str, str]]

    @classmethod
    def open(cls, path: Path) -> EpisodeFile:
        """Read the metadata of a file. Raises NotFound where there is none and Corrupt where it is no episode."""
        with BoundedFile(path) as file, corruption(path):
            foreign = foreign_kind(file)
            if foreign:
                raise ForeignFile(f"{path} {foreign}.")
            return cls(path, read_metadata(file, is_finished(path)))

    @property
    def episode(self) -> EpisodeRecord:
        """What was recorded: room, number, task, arms, outcome and so on, as the recorder wrote it down."""
        return self._read(EpisodeRecord)

    @property
    def cadence(self) -> CadenceRecord:
        """How well time was kept."""
        return self._read(CadenceRecord)

    @property
    def operators(self) -> OperatorsRecord:
        """Who drove each arm, with changes."""
        return self._read(OperatorsRecord)

    @property
    def verification(self) -> VerificationRecord:
        """What re-simulation said when the file was completed."""
        return self._read(VerificationRecord)

    @property
    def room(self) -> RoomRecord:
        """Tell of what room the file is, also where it was cut short."""
        return self._read(RoomRecord)

    def states(self) -> Iterator[State]:
        """Iterate over the states in the order of the file, the one after the reset first. Raises Corrupt."""
        return (state for state, _ in self._states())

    def _states(self) -> Iterator[tuple[State, int]]:
        """Iterate over the states, each with when it came (Unix time)."""
        for message in self.messages(STATE):
            try:
                yield codec.decode(State, message.payload), message.arrived_ns
            except InvalidInput as error:
                raise Corrupt(f"{self.path} holds a state that cannot be read: {error}") from error

    def steady_states(self) -> Iterator[State]:
        """Iterate as `states` does, with `fired_ns` and `stepped_ns` as if no clock had been set meanwhile."""
        fired, stepped = SteadyTime(), SteadyTime()
        for state, arrived_ns in self._states():
            state.stamps.fired_ns = max(0, fired.steady_ns(state.stamps.fired_ns, arrived_ns))
            state.stamps.stepped_ns = max(0, stepped.steady_ns(state.stamps.stepped_ns, arrived_ns))
            yield state

    def arrays(
        self,
        task: Task | None = None,
        control_hz: float | None = None,
        *,
        with_integration_states: bool = True,
    ) -> EpisodeData:
        """Read the whole episode into numpy arrays.

        task: whose observations and shapes are wanted; None takes the one that the file names, or, where the catalogue
        has no such task, every observation of the file as it is.
        control_hz: ticks a second that are wanted, at most those of the recording (`mart.episodes.resampling`); None
        takes every tick.
        with_integration_states: whether MuJoCo's states are wanted, too, which are nine tenths of all: of an hour of
        three arms 343 MB.
        Raises Corrupt where the file is damaged and InvalidInput, naming it, where ticks, arms or observations are
        missing, a number is NaN, or the rate cannot be had.
        """
        known = self._known_task() if task is None else task
        who = self.operators if OperatorsRecord.NAME in self.metadata else None
        try:
            data = arrays_of(self.states(), known, who, with_integration_states=with_integration_states)
        except InvalidInput as error:
            raise InvalidInput(f"{self.path} cannot be read into arrays: {error}") from error
        return self.resampled(data, control_hz, known)

    def resampled(self, data: EpisodeData, control_hz: float | None, task: Task | None = None) -> EpisodeData:
        """Return what was read of every tick in ticks of `control_hz`; None leaves it as it is.

        task: as for `arrays`. Raises InvalidInput, naming the file, where the rate cannot be had.
        """
        if control_hz is None:
            return data
        known, recorded_hz = task or self._known_task(), self.episode.control_hz
        if known is None or recorded_hz is None:
            raise InvalidInput(
                f"{self.path} cannot be read into arrays: another control rate was asked for, and it names no task of "
                "the catalogue or no rate; read it as it is."
            )
        try:
            return at_control_hz(data, recorded_hz, control_hz, [arm.kind.limits for arm in known.arms])
        except InvalidInput as error:
            raise InvalidInput(f"{self.path} cannot be read into arrays: {error}") from error

    def with_integration_states(self, segments: Sequence[EpisodeData]) -> list[EpisodeData]:
        """Return parts of this episode that were read without MuJoCo's states with them: those of their ticks alone."""
        places: dict[int, list[tuple[int, int]]] = {}
        for number, segment in enumerate(segments):
            for row, tick in enumerate(segment.ticks.tolist()):
                places.setdefault(tick, []).append((number, row))
        filled: list[NDArray[np.float64]] = []
        for tick, state in enumerate(self.states()):
            values = np.frombuffer(state.integration_state, "<f8")
            filled = filled or [np.zeros((len(one.ticks), len(values))) for one in segments]
            for number, row in places.get(tick, ()):
                filled[number][row] = values
        return [replace(one, integration_states=rows) for one, rows in zip(segments, filled, strict=True)]

    def messages(self, *topics: str) -> Iterator[RecordedMessage]:
        """Iterate over the messages of these topics, or of all, in the order of the file.

        Raises Corrupt, at the end also where a finished file holds another number of messages than it says.
        """
        with BoundedFile(self.path) as file, corruption(self.path):
            for channel, message in read_messages(file, is_finished(self.path)):
                if not topics or channel.topic in topics:
                    yield RecordedMessage(
                        channel.topic, message.data, message.log_time, message.publish_time, message.sequence
                    )

    def model(self) -> bytes:
        """Return the compiled MuJoCo model (MJB), of which both its checksum and the room's SHA-256 are found right.

        Raises NotFound where the file has none and Corrupt where it is another than the recorded one.
        """
        with BoundedFile(self.path) as file, corruption(self.path):
            for attachment in read_attachments(file, is_finished(self.path)):
                if attachment.name == MODEL_ATTACHMENT:
                    self._require_recorded(attachment.data)
                    return attachment.data
        raise NotFound(f"{self.path} holds no {MODEL_ATTACHMENT}.")

    def task_file(self) -> bytes | None:
        """Return the task file (TOML) that an episode of somebody's own task carries, None where it has none."""
        with BoundedFile(self.path) as file, corruption(self.path):
            for attachment in read_attachments(file, is_finished(self.path)):
                if attachment.name == TASK_ATTACHMENT:
                    return attachment.data
        return None

    def task(self) -> Task:
        """Return the task that was recorded: the catalogue's, or as the file's own task file says it.

        Raises NotFound for one that neither knows, InvalidInput for arms that it cannot have.
        """
        episode = self.episode
        name = episode.task or ""
        own = None if is_in_catalogue(name) else self.task_file()
        if own is None:
            return get_task(name, len(episode.arms), episode.arm_kinds)
        return recorded_task(name, own, episode.arm_kinds)

    def check_model(self) -> None:
        """Raise Corrupt where the file holds another model than the recorded one; one without any is as good."""
        with contextlib.suppress(NotFound):
            self.model()

    def check(self, expected_messages: int | None = None) -> None:
        """Read all of the file, every checksum included, attachments' too.

        Raises Corrupt where anything is amiss or missing.
        """
        found = sum(1 for _ in self.messages())
        with BoundedFile(self.path) as file, corruption(self.path):
            statistics = read_summary(file).statistics
            require_intact_data(file)
            for _ in read_attachments(file, finished=True):
                pass
        EpisodeFile.open(self.path).check_model()
        counted = statistics.message_count if statistics else found
        if found != counted or expected_messages not in (None, found):
            expected = counted if expected_messages is None else expected_messages
            raise Corrupt(f"{self.path} holds {found} messages; it should hold {expected}.")

    def _require_recorded(self, mjb: bytes) -> None:
        said = self.metadata.get(RoomRecord.NAME, {}).get("model_sha256")
        if said is not None and sha256(mjb).hexdigest() != said:
            raise ValueError(f"its {MODEL_ATTACHMENT} is not the model whose SHA-256 it names")

    def _read(self, record: type[R]) -> R:
        strings = self.metadata.get(record.NAME)
        if strings is None:
            raise Corrupt(f"{self.path} has no record {record.NAME}; is it an episode of MART?")
        try:
            return record.from_strings(strings)
        except Corrupt as error:
            raise Corrupt(f"{self.path}{self._written_by()} cannot be understood. {error}") from error

    def _written_by(self) -> str:
        """Say which version wrote the file, where it is not the one that reads it."""
        versions = self.metadata.get(VERSIONS, {})
        wrote = versions.get(_DISTRIBUTION) or versions.get("mart-recorder")
        return f", written by version {wrote} of MART and read by {_own_version()}," if wrote else ""

    def _known_task(self) -> Task | None:
        try:
            return self.task()
        except (InvalidInput, NotFound):
            return None


def is_finished(path: Path) -> bool:
    """Whether a file must be whole, by its name. Any other, such as a `.part`, ends where it was cut."""
    return path.suffix == SUFFIX


@functools.cache
def _own_version() -> str:
    return version(_DISTRIBUTION)
