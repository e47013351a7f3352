"""Run the steps of a reproduction as processes, and write down what became of each, so that a kill costs little."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fcntl import LOCK_EX, LOCK_NB, flock
from pathlib import Path

from mart.platform.reproduce.fingerprints import Fingerprints
from mart.platform.reproduce.schedule import StepState, duration, ready, remaining, state_of
from mart.platform.reproduce.step_process import RunningStep, StepProcess
from mart.platform.reproduce.versions import versions
from mart.protocol import clock
from mart.protocol.errors import Conflict, Unavailable
from mart.runtime.step_record import LOGS, PlannedStep, StepAttempt, StepRecord, read_records, write_record

_LOOK_EVERY_S = 0.2
_SET_ASIDE = "set-aside"
GIGABYTE = 10**9


@dataclass(frozen=True)
class Outcome:
    """How the steps stand in the end. why: of those that are not done, in a clause."""

    states: Mapping[str, StepState]
    why: Mapping[str, str]
    stopped: bool

    @property
    def complete(self) -> bool:
        """Whether every step is done."""
        return all(state is StepState.DONE for state in self.states.values())


@dataclass
class Runner:
    """Run steps in `folder`, `jobs` at a time; what is done already, from the same inputs, is not done again.

    redo: set aside what was made from other inputs or by other commands, and make it anew; else it is left and told.
    least_free: bytes on the disk with which nothing more is begun. tell: a line of progress. start, free: how a step is
    started, and how many bytes a folder's disk has left.
    """

    folder: Path
    steps: Sequence[PlannedStep]
    tell: Callable[[str], object]
    jobs: int = 1
    redo: bool = False
    least_free: int = GIGABYTE
    start: Callable[[Path, PlannedStep, int], RunningStep] = StepProcess.start
    free: Callable[[Path], int] = lambda folder: shutil.disk_usage(folder).free
    _records: dict[str, StepRecord] = field(default_factory=dict)
    _states: dict[str, StepState] = field(default_factory=dict)
    _why: dict[str, str] = field(default_factory=dict)
    _running: dict[str, RunningStep] = field(default_factory=dict)

    def run(self, stop: threading.Event) -> Outcome:
        """Run until nothing can be begun any more, or `stop` is set. A failed step is told; the others go on.

        Raises Conflict where another process works in the folder, Unavailable where its disk is full.
        """
        with _claimed(self.folder):
            self._fingerprints = Fingerprints(self.folder)
            self._records = read_records(self.folder)
            self._states = {step.name: StepState.TODO for step in self.steps}
            try:
                self._look()
                self._work(stop)
            except OSError as error:
                raise Unavailable(
                    f"{self.folder} cannot be written ({error.strerror}); what is done stays done: mend it, and give "
                    "the same command again."
                ) from error
            finally:
                for process in self._running.values():
                    process.stop()
                for name in list(self._running):
                    self._end(name, interrupted=True)
                self._fingerprints.keep()
        return Outcome(self._states, self._why, stop.is_set())

    def _work(self, stop: threading.Event) -> None:
        while not stop.is_set():
            begun = self._begin_ready()
            if not self._running and not begun:
                return
            stop.wait(_LOOK_EVERY_S)
            ended = [name for name, process in self._running.items() if process.ended]
            for name in ended:
                self._end(name, interrupted=False)
            if ended:
                self._look()

    def _look(self) -> None:
        """Find out what is done already; a step is looked at when all that it needs is done."""
        for step in self.steps:
            needed = all(self._states.get(name) is StepState.DONE for name in step.after)
            if self._states[step.name] is not StepState.TODO or not needed or step.name in self._running:
                continue
            inputs = {path: self._fingerprints.of(path) for path in step.inputs}
            result, record = self._fingerprints.of(step.result), self._records.get(step.name)
            state, why = state_of(step, record, inputs, result)
            if state is StepState.CHANGED and self.redo:
                self.tell(
                    f"{step.name}: {why}; it is made anew, and what was there is in {self._set_aside(step)}"
                )
                state, why = StepState.TODO, ""
            self._states[step.name] = state
            if why:
                self._why[step.name] = why
                self.tell(f"{step.name}: {why}")
            if state is StepState.DONE and record is not None:
                self._note(record, result)

    def _note(self, record: StepRecord, result: str) -> None:
        """Say what a reader of a finished step has to know."""
        notes = []
        if record.result != result:
            notes.append("its result was changed since it was made")
        older = {name: own for name, own in record.versions.items() if versions().get(name, own) != own}
        if older:
            notes.append(
                "it was made with " + ", ".join(f"{name} {own}" for name, own in sorted(older.items()))
            )
        note = "; ".join(notes)
        if note and note != record.note:
            self.tell(f"{record.step.name} is used as it is, but {note}")
            self._write(record.model_copy(update={"note": note}))

    def _begin_ready(self) -> bool:
        begun = False
        while len(self._running) < self.jobs:
            able = ready(self.steps, self._states, self._running)
            if not able:
                break
            self._require_space()
            self._begin(able[0])
            begun = True
        return begun

    def _require_space(self) -> None:
        free = self.free(self.folder)
        if free < self.least_free:
            raise Unavailable(
                f"The disk of {self.folder} has {free / GIGABYTE:.1f} GB left, and {self.least_free / GIGABYTE:.1f} GB "
                "are wanted before anything is begun. Nothing is lost: make room, and give the same command again."
            )

    def _begin(self, step: PlannedStep) -> None:
        before = self._records.get(step.name)
        if step.kind == "collect" and (self.folder / step.result).exists():
            self.tell(f"{step.name} was interrupted; what it had is in {self._set_aside(step)}")
        attempts = tuple(self._closed(step, attempt) for attempt in before.attempts) if before else ()
        record = StepRecord(
            step=step,
            status="running",
            inputs={path: self._fingerprints.of(path) for path in step.inputs},
            attempts=(*attempts, StepAttempt(began_ns=clock.wall_ns())),
            versions=dict(versions()),
        )
        self._write(record)
        self._running[step.name] = self.start(self.folder, step, self.jobs)
        self._states[step.name] = StepState.RUNNING
        self._progress(f"{step.name} …")

    def _closed(self, step: PlannedStep, attempt: StepAttempt) -> StepAttempt:
        """Return an attempt; one that a kill has left open as ended when its log was written last."""
        if attempt.ended_ns is not None:
            return attempt
        log = self.folder / LOGS / f"{step.name}.log"
        last_ns = log.stat().st_mtime_ns if log.is_file() else attempt.began_ns
        return attempt.model_copy(update={"ended_ns": max(last_ns, attempt.began_ns)})

    def _end(self, name: str, *, interrupted: bool) -> None:
        process = self._running.pop(name)
        code, why = process.finish()
        full = code != 0 and self.free(self.folder) < self.least_free
        *earlier, last = self._records[name].attempts
        ended = last.model_copy(update={"ended_ns": clock.wall_ns(), "exit_code": code})
        status = "done" if code == 0 else "interrupted" if interrupted or full else "failed"
        record = self._records[name].model_copy(
            update={
                "status": status,
                "attempts": (*earlier, ended),
                "result": self._fingerprints.of(process.step.result),
                "why": why,
            }
        )
        self._states[name] = {"done": StepState.DONE, "failed": StepState.FAILED}.get(status, StepState.TODO)
        self._write(record)
        if status == "failed":
            self._why[name] = f"{why or f'exit code {code}'} (see {LOGS}/{name}.log)"
            self._progress(f"{name} failed: {self._why[name]}")
        elif status == "done":
            self._progress(f"{name} is done in {duration(ended.wall_s)}")

    def _write(self, record: StepRecord) -> None:
        self._records[record.step.name] = record
        write_record(self.folder, record)

    def _set_aside(self, step: PlannedStep) -> Path:
        """Move a result away, and say where it is now: nothing is overwritten."""
        place = self.folder / _SET_ASIDE / f"{step.name}-{clock.wall_ns()}"
        place.parent.mkdir(parents=True, exist_ok=True)
        (self.folder / step.result).rename(place)
        return place.relative_to(self.folder)

    def _progress(self, line: str) -> None:
        done = sum(state is StepState.DONE for state in self._states.values())
        left = remaining(self.steps, self._states, self._records, self.jobs).in_words()
        self.tell(f"[{done}/{len(self.steps)}] {line} ({left})")


@contextmanager
def _claimed(folder: Path) -> Iterator[None]:
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "reproduce.lock").open("ab") as lock:
        try:
            flock(lock, LOCK_EX | LOCK_NB)
        except BlockingIOError as error:
            raise Conflict(
                f"Another `mart reproduce` works in {folder}; wait, or name another folder."
            ) from error
        yield
