"""Put the episodes of several named data sets together under a new name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal

from mart.episodes import datasets, labels
from mart.episodes.compatibility import require_alike
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.recording import VERSIONS
from mart.recorder.catalogue.dataset_editing import DataSetEdit, take_in

Field = Literal["control_hz", "versions"]  # that may differ where it is asked for

_FORMAT = "mart-protocol"  # the part that says what a file means
_MENDS: Mapping[Field, str] = {
    "control_hz": "Training and exports take them all at one rate, 20 Hz unless told another: merge them with "
    "`--allow control_hz`, or those of one rate alone.",
    "versions": "Worlds of another MuJoCo move a little differently, and files of another MART may say less: merge "
    "them with `--allow versions`, or those of one version alone.",
}


def merge(
    root: Path,
    name: str,
    sources: Sequence[str],
    known: Iterable[LabelledEpisode],
    *,
    allowed: Collection[Field] = (),
    now_ns: int,
    by: str = "",
) -> DataSetEdit:
    """Make every episode of `sources` part of a new data set `name`.

    known: all episodes that there are. allowed: what of them may differ; nothing else does.

    Raises Conflict where there is one of this name, NotFound for a source that is none, and InvalidInput for sources in
    another folder, for files that cannot be read, and for several tasks, arms, kinds of arms, rates or versions.
    """
    said = labels.read_folded(root)
    held = datasets.named(said)
    if name in held:
        raise Conflict(f"There is a data set {name!r} already; merge under a new name.")
    for source in sources:
        _require_here(root, source, held)
    wanted = {path for source in sources for path in held[source].episodes}
    rows = list(known)
    chosen = [row for row in rows if row.path in wanted]
    broken = [row for row in chosen if row.error is not None and not row.dropped]
    if broken:
        raise InvalidInput(
            f"{broken[0].path}, of {len(broken)} of the episodes, cannot be read: {broken[0].error} "
            "Mend it with `mart episodes repair`, or leave it out with `mart episodes label --drop`."
        )
    _require_mergeable([row for row in chosen if not row.dropped], sources, allowed)
    return take_in(root, name, chosen, rows, now_ns=now_ns, by=by)


def _require_mergeable(
    rows: Sequence[LabelledEpisode], sources: Collection[str], allowed: Collection[Field]
) -> None:
    require_alike(rows, "a data set holds one: merge those of one alone", any_rate=True)
    for field, values in _differing(rows, sources, allowed):
        if len(values) > 1:
            found = [f"{value} ({', '.join(sorted(names))})" for value, names in sorted(values.items())]
            raise InvalidInput(f"The data sets differ in {field}: {'; '.join(found)}. {_MENDS[field]}")


def _differing(
    rows: Sequence[LabelledEpisode], sources: Collection[str], allowed: Collection[Field]
) -> Iterator[tuple[Field, dict[str, set[str]]]]:
    """Iterate over what must be one, with its values and the data sets that have each."""
    if "control_hz" not in allowed:
        yield "control_hz", _rates(rows, sources)
    if "versions" not in allowed:
        yield "versions", _versions(rows, sources)


def _rates(rows: Iterable[LabelledEpisode], sources: Collection[str]) -> dict[str, set[str]]:
    """Return which data sets have episodes of each control rate."""
    return _by_value(((f"{row.control_hz:g} Hz", row) for row in rows if row.control_hz), sources)


def _versions(rows: Iterable[LabelledEpisode], sources: Collection[str]) -> dict[str, set[str]]:
    """Return which data sets have episodes of each version of the file format's part and of MuJoCo.

    The last number of a version changes neither, and what a file does not say differs from nothing.
    """
    said = ((_version_of(EpisodeFile.open(row.file_path)), row) for row in rows)
    return _by_value(((version, row) for version, row in said if version), sources)


def _version_of(file: EpisodeFile) -> str:
    mart, mujoco = file.metadata.get(VERSIONS, {}).get(_FORMAT, ""), file.room.mujoco_version or ""
    told = {"MART": mart, "MuJoCo": mujoco}
    return ", ".join(f"{name} {'.'.join(text.split('.')[:2])}" for name, text in told.items() if text)


def _by_value(told: Iterable[tuple[str, LabelledEpisode]], sources: Collection[str]) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for value, row in told:
        found.setdefault(value, set()).update(set(row.datasets) & set(sources))
    return found


def _require_here(root: Path, source: str, held: Iterable[str]) -> None:
    if source in held:
        return
    if "/" in source or Path(source).is_dir():
        raise InvalidInput(
            f"The data set {source[:200]!r} was given; only data sets of one folder, here {root}, are merged: copy the "
            "episodes of the other folder, with their labels.jsonl, into it, and name the data sets alone."
        )
    raise NotFound.named("data set", source[:100], held)
