"""Put the episodes of several named data sets together under a new name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from mart.episodes import datasets, labels
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.recorder.catalogue.dataset_editing import DataSetEdit, take_in


def merge(
    root: Path,
    name: str,
    sources: Sequence[str],
    known: Iterable[LabelledEpisode],
    *,
    now_ns: int,
    by: str = "",
) -> DataSetEdit:
    """Make every episode of `sources` part of a new data set `name`. known: all episodes that there are.

    Raises Conflict where there is one of this name, NotFound for a source that is none, and InvalidInput for sources in
    another folder, for files that cannot be read, and for several tasks, arms or kinds of arms.
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
    return take_in(root, name, chosen, rows, now_ns=now_ns, by=by)


def _require_here(root: Path, source: str, held: Iterable[str]) -> None:
    if source in held:
        return
    if "/" in source or Path(source).is_dir():
        raise InvalidInput(
            f"The data set {source[:200]!r} was given; only data sets of one folder, here {root}, are merged: copy the "
            "episodes of the other folder, with their labels.jsonl, into it, and name the data sets alone."
        )
    raise NotFound.named("data set", source[:100], held)
