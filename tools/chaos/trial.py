"""Try one fault: an episode that two emulated people drive, the fault in its middle, and the episode after it."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from mart.episodes.folder import find_episodes
from mart.episodes.reader import EpisodeFile
from mart.platform.collect.emulated_users import EmulatedUser
from mart.platform.run.platform_processes import processes_of
from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.vocabulary import Verdict
from tools.chaos.faults import Fault, Scene
from tools.chaos.row import RecordedFile, Row, in_words, judge, lost, standstill, told
from tools.chaos.running import ROOM
from tools.chaos.witness import Witness, witnessing

_INTO_EPISODE = 50  # ticks
_BEGIN_TIMEOUT_S = 60.0
_END_TIMEOUT_S = 60.0  # after the fault
_SAVED_TIMEOUT_S = 45.0
_NEXT_TIMEOUT_S = 90.0
_SETTLED_S = 3.0
_LOOK_EVERY_S = 0.5
_READY_EVERY_S = 3.0
_DEAD_S = 5.0


@dataclass(frozen=True)
class Trial:
    """A row, and the episode that was under way: its number, and the ticks that it should hold."""

    row: Row
    number: int
    expected: frozenset[int]


def try_fault(fault: Fault, scene: Scene, people: Sequence[EmulatedUser]) -> Trial:
    """Try a fault; of one that ends the platform the row says what is known until then.

    Raises NotHere where it cannot be tried, and TimeoutError where no episode begins.
    """
    with witnessing(scene.running, people[0].web_client) as witness:
        number = _begin(witness, people)
        before = scene.running.commands()
        with fault.does(scene):
            fault_s = clock.monotonic_s()  # a disk takes a moment to be filled
            clock.sleep_s(max(fault.lasts_s, _DEAD_S if fault.ends_platform else 0.0))
        row = Row(fault.name)
        if fault.ends_platform:
            witness.wait_for(lambda: bool(_told(witness, fault, fault_s)[1]), _DEAD_S)
            row.left_over = _left(scene.running.mark)
            row.felt_s = max(witness.states[-1][0] - fault_s, 0.0)
        else:
            _await_end(witness, number)
        row.standstill_s, row.back_s = standstill(witness.states, witness.events, fault_s)
        row.told_s, row.told = _told(witness, fault, fault_s)
        row.told = row.told.replace(str(scene.data_dir), "data")
        expected = expected_ticks(witness, number)
        if not fault.ends_platform:
            look_at_files(row, scene.data_dir, number, expected)
            row.next_verified = next_is_verified(witness, people, scene.data_dir)
            if not row.gap_named or row.lost_s:  # what a full disk left is mended after the next save
                look_at_files(row, scene.data_dir, number, expected)
            row.left_over = _more_than(before, scene)
            finish(row, fault)
    return Trial(row, number, expected)


def finish(row: Row, fault: Fault) -> None:
    """Judge a row that is complete."""
    felt = fault.ends_platform or row.standstill_s > 0.5 or row.lost_s > 0
    row.short = judge(row, fault.names, felt=felt, ends_platform=fault.ends_platform)


def look_at_files(row: Row, data_dir: Path, number: int, expected: frozenset[int]) -> None:
    """Wait until the episode's files are named and verified, or not any more, and read them."""
    deadline_s = clock.monotonic_s() + _SAVED_TIMEOUT_S
    files = recorded(data_dir, number)
    while not _is_settled(files, expected) and clock.monotonic_s() < deadline_s:
        clock.sleep_s(_LOOK_EVERY_S)
        files = recorded(data_dir, number)
    row.lost_s = lost(expected, files)
    row.episode = in_words(files, expected)
    whole = any(file.verdict == Verdict.VERIFIED for file in files) and row.lost_s == 0.0
    row.gap_named = whole or any(not file.complete for file in files) or len(files) > 1


def expected_ticks(witness: Witness, number: int) -> frozenset[int]:
    """Every tick between the first and the last that was heard of the episode, or that its end named."""
    ticks = [tick for _, tick, episode in witness.states if episode == number]
    ticks += [
        event.episode_ended.last_tick
        for _, event in witness.events
        if event.HasField("episode_ended")
        and event.episode_ended.number == number
        and event.episode_ended.last_tick
    ]
    return frozenset(range(min(ticks), max(ticks) + 1))


def recorded(data_dir: Path, number: int) -> list[RecordedFile]:
    """Return the episode's finished files."""
    found = []
    for labelled in find_episodes(data_dir / "episodes", ROOM, number):
        with contextlib.suppress(MartError, OSError):
            file = EpisodeFile.open(labelled.file_path)
            found.append(
                RecordedFile(
                    frozenset(state.tick for state in file.states()),
                    str(file.episode.outcome),
                    str(labelled.verdict),
                    file.episode.complete and not file.cadence.messages_lost,
                    labelled.dropped,
                )
            )
    return found


def next_is_verified(witness: Witness, people: Sequence[EmulatedUser], data_dir: Path) -> bool:
    """Record one more episode, and say whether its file is verified."""
    try:
        number = _begin(witness, people, ticks=1)
    except TimeoutError:
        return False
    _await_end(witness, number)
    deadline_s = clock.monotonic_s() + _NEXT_TIMEOUT_S
    while clock.monotonic_s() < deadline_s:
        files = recorded(data_dir, number)
        if any(file.verdict == Verdict.VERIFIED and file.complete for file in files):
            return True
        clock.sleep_s(_LOOK_EVERY_S)
    return False


def _is_settled(files: Sequence[RecordedFile], expected: frozenset[int]) -> bool:
    verified = bool(files) and all(file.verdict == Verdict.VERIFIED for file in files)
    return verified and lost(expected, files) == 0.0


def _begin(witness: Witness, people: Sequence[EmulatedUser], ticks: int = _INTO_EPISODE) -> int:
    """Say ready until an episode has run for so many ticks; return its number."""
    newest = max((episode for _, _, episode in witness.states), default=0)
    deadline_s = clock.monotonic_s() + _BEGIN_TIMEOUT_S

    def runs() -> bool:
        recent = [episode for _, _, episode in witness.states[-ticks:]]
        return len(recent) == ticks and min(recent) > newest and len(set(recent)) == 1

    while clock.monotonic_s() < deadline_s:
        if not witness.states or witness.states[-1][2] <= newest:
            for person in people:
                with contextlib.suppress(MartError):  # ready already, or the room is away for a moment
                    person.web_client.act(ROOM, person.arm, "ready")
        if witness.wait_for(runs, _READY_EVERY_S):
            return witness.states[-1][2]
        if witness.states and witness.states[-1][2] > newest and witness.wait_for(runs, _BEGIN_TIMEOUT_S):
            return witness.states[-1][2]
    raise TimeoutError("No episode begins.")


def _await_end(witness: Witness, number: int) -> None:
    witness.wait_for(lambda: bool(witness.states) and witness.states[-1][2] != number, _END_TIMEOUT_S)
    clock.sleep_s(_SETTLED_S)


def _told(witness: Witness, fault: Fault, fault_s: float) -> tuple[float | None, str]:
    return told(witness.shown, fault.names, fault_s)


def _left(mark: str) -> int:
    """How many processes of a platform that ended are there, once those that end by themselves have."""
    deadline_s = clock.monotonic_s() + 45.0
    while (left := len(processes_of(mark))) and clock.monotonic_s() < deadline_s:
        clock.sleep_s(_LOOK_EVERY_S)
    return left


def _more_than(before: Counter[str], scene: Scene) -> int:
    """How many processes there are more than before, once those that come and go have."""
    deadline_s = clock.monotonic_s() + 15.0
    while (more := scene.running.commands() - before) and clock.monotonic_s() < deadline_s:
        clock.sleep_s(_LOOK_EVERY_S)
    if more:
        click.echo(f"More than before: {dict(more)}", err=True)
    return more.total()
