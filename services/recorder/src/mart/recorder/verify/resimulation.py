"""Tell whether a file's ticks follow from each other: re-simulated by a replica, compared bit for bit.

From the first state on, the applied actions of each tick are stepped again in the same world, and a digest of every
integration state is compared with the recorded one. A stretch ends where ticks are missing, and after some thousand
ticks; each begins at a recorded state. What else a file says is not covered: who drove, outcome, stamps, pictures.

Numbers depend on processor and C library as well (`Numerics`). Where a re-simulation differs, and was computed with
others than the recording, it says nothing about the recording: the verdict is `unverified`, with the difference.
What drivers measured on real arms follows from nothing that could be stepped: the verdict is `real`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, MartError, Unavailable
from mart.protocol.messages import Numerics, RolloutRequest
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.state_digest import DIGEST_BYTES
from mart.protocol.vocabulary import Verdict
from mart.recorder.verify.replica import AskReplica, nobody, replica
from mart.recorder.verify.stretches import Stretch, own_task_of, stretches
from mart.recorder.verify.tolerance import Comparison, compare_ticks

_FAR = 1e15  # what a record's number may be

__all__ = ["AskReplica", "ComparedStretch", "Stretch", "compare", "nobody", "replica", "stretches", "verify"]


def verify(file: EpisodeFile, room: RoomRecord, ask: AskReplica) -> VerificationRecord:
    """Step a file again and return the verdict. Never raises for what it finds: a doubt is a verdict."""
    try:
        measured = _measured_arms(file)
        if measured:
            detail = f"Not re-simulated: real. Measured: {', '.join(measured)}."
            return _record(room, Verdict.REAL, detail)
        return _judge(file, room, ask)
    except MartError as error:
        return _record(room, Verdict.UNVERIFIED, str(error), pending=isinstance(error, Unavailable))


@dataclass(frozen=True)
class ComparedStretch:
    """Tell of one stretch that was stepped again which of its ticks led elsewhere.

    numerics: of the process that stepped it; empty where nothing had to be stepped.
    """

    first_tick: int
    last_tick: int
    different: tuple[int, ...]
    numerics: Numerics


def compare(
    file: EpisodeFile, room: RoomRecord, ask: AskReplica, *, native: bool = False
) -> Iterator[ComparedStretch]:
    """Step every stretch of a file again. Raises Corrupt, or what the replica says where it cannot answer.

    native: in a process that computes with the C library's own choice for the replica's processor.
    """
    if not (room.task and room.control_hz and room.model_sha256):
        raise Corrupt(
            f"{file.path} does not say its task, its rate and its model; it cannot be stepped again."
        )
    EpisodeFile(file.path, {RoomRecord.NAME: room.to_strings()}).check_model()
    own = own_task_of(file, room)
    for stretch in stretches(file.states()):
        answered, numerics = b"", Numerics()
        if stretch.digests:
            reply = ask(RolloutRequest(resimulate=stretch.request(room, own, native=native)))
            answered, numerics = reply.state_digests, reply.numerics
        if len(answered) != DIGEST_BYTES * len(stretch.digests):
            raise Corrupt(f"The replica answered {len(answered)} bytes for {len(stretch.digests)} ticks.")
        again = [answered[i : i + DIGEST_BYTES] for i in range(0, len(answered), DIGEST_BYTES)]
        pairs = enumerate(zip(stretch.digests, again, strict=True), stretch.first_tick + 1)
        different = tuple(tick for tick, (a, b) in pairs if a != b)
        yield ComparedStretch(stretch.first_tick, stretch.last_tick, different, numerics)


@dataclass(frozen=True)
class _SteppedAgain:
    """How far a file follows: its first tick that differs, or what was checked."""

    first_different: int | None
    checked: int
    gaps: tuple[str, ...]
    numerics: Numerics


def _judge(file: EpisodeFile, room: RoomRecord, ask: AskReplica) -> VerificationRecord:
    found = _step_again(file, room, ask, native=False)
    native = False
    if found.first_different is not None and not _same(room, found.numerics):
        other = _step_again(file, room, ask, native=True)
        if other.first_different is None or _same(room, other.numerics) or not room.numeric_fingerprint:
            found, native = other, True
    if found.first_different is not None:
        return _judge_difference(file, room, ask, found, native=native)
    fingerprint = found.numerics.fingerprint
    if not found.checked:
        return _record(room, Verdict.UNVERIFIED, "It holds no tick that follows from another.")
    ticks = f"{found.checked} ticks re-simulated bit for bit"
    if found.gaps:
        detail = f"{ticks}; not those from {', '.join(found.gaps[:8])}."
        return _record(room, Verdict.UNVERIFIED, detail, fingerprint=fingerprint)
    return _record(room, Verdict.VERIFIED, f"{ticks}.", fingerprint=fingerprint)


def _judge_difference(
    file: EpisodeFile, room: RoomRecord, ask: AskReplica, found: _SteppedAgain, *, native: bool
) -> VerificationRecord:
    comparison, size = _compared(file, room, ask, native=native)
    differs = f"Re-simulation differs from tick {found.first_different} on. {size}"
    recorded, again = room.numerics, found.numerics
    if recorded.fingerprint == again.fingerprint:
        verdict, why = Verdict.DIVERGED, ""
    elif recorded.fingerprint:
        verdict, why = Verdict.UNVERIFIED, f"Other processor: recorded on {_words(recorded)}. "
    elif comparison and comparison.within_tolerance:
        verdict, why = Verdict.UNVERIFIED, "Recorded before fingerprints, it may be, on another processor. "
    else:
        verdict, why = Verdict.DIVERGED, ""
    detail = f"{why}{differs}" + (f" It was stepped on {_words(again)}." if why else "")
    return _record(
        room,
        verdict,
        detail,
        fingerprint=again.fingerprint,
        first_different=found.first_different,
        comparison=comparison,
    )


def _compared(
    file: EpisodeFile, room: RoomRecord, ask: AskReplica, *, native: bool
) -> tuple[Comparison | None, str]:
    """Return by how much it differs, and that in words. Raises Unavailable."""
    try:
        comparison = compare_ticks(file, room, ask, native=native)
    except Unavailable:
        raise
    except MartError as error:
        return None, f"By how much cannot be told: {error}"
    return comparison, str(comparison)


def _step_again(file: EpisodeFile, room: RoomRecord, ask: AskReplica, *, native: bool) -> _SteppedAgain:
    checked, gaps, last_tick, numerics = 0, list[str](), None, Numerics()
    for stretch in compare(file, room, ask, native=native):
        numerics = stretch.numerics if stretch.numerics.fingerprint else numerics
        if stretch.different:
            return _SteppedAgain(stretch.different[0], checked, (), numerics)
        if last_tick not in (None, stretch.first_tick):
            gaps.append(f"{last_tick} to {stretch.first_tick}")
        last_tick = stretch.last_tick
        checked += stretch.last_tick - stretch.first_tick
    return _SteppedAgain(None, checked, tuple(gaps), numerics)


def _measured_arms(file: EpisodeFile) -> list[str]:
    """Return the arms that drivers measured; a room does not change which those are."""
    first = next(iter(file.states()), None)
    return [arm.arm for arm in first.arms if arm.measured] if first is not None else []


def _same(room: RoomRecord, numerics: Numerics) -> bool:
    return bool(numerics.fingerprint) and room.numeric_fingerprint == numerics.fingerprint


def _words(numerics: Numerics) -> str:
    said = filter(None, (numerics.processor, numerics.libm, f"MuJoCo {numerics.mujoco_build}"))
    return f"{', '.join(said)} (fingerprint {numerics.fingerprint})"


def _record(
    room: RoomRecord,
    verdict: Verdict,
    detail: str,
    *,
    fingerprint: str = "",
    first_different: int | None = None,
    comparison: Comparison | None = None,
    pending: bool = False,
) -> VerificationRecord:
    differences = comparison.differences.items() if comparison else ()
    return VerificationRecord(
        verdict=verdict,
        detail=detail,
        model_sha256=room.model_sha256,
        mujoco_version=room.mujoco_version,
        pending=pending,
        numeric_fingerprint=fingerprint or None,
        first_different_tick=first_different,
        within_tolerance=comparison.within_tolerance if comparison else None,
        largest_difference={name: min(one.largest, _FAR) for name, one in differences},
    )
