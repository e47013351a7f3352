"""Put episodes into named data sets and take them out: what the command line and the catalogue share.

Each act says `by` whom it is, as others see them; empty where that is not known.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mart.episodes import datasets, labels
from mart.episodes.compatibility import require_alike
from mart.episodes.datasets import NamedDataSet
from mart.episodes.filter import COUNTED
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.labels import Label
from mart.protocol.errors import InvalidInput, NotFound


@dataclass(frozen=True)
class DataSetEdit:
    """Tell what an act changed. left_out: why → how many. dataset: as it is now. act_ns: undoes it; 0: nothing."""

    dataset: NamedDataSet
    changed: int
    act_ns: int
    left_out: Mapping[str, int] = field(default_factory=dict)


def take_in(
    root: Path,
    name: str,
    chosen: Iterable[LabelledEpisode],
    known: Iterable[LabelledEpisode],
    *,
    now_ns: int,
    by: str = "",
) -> DataSetEdit:
    """Make `chosen` part of a data set, but for those that nobody shall learn from. known: all that there are.

    Raises InvalidInput where nothing is left, or for episodes of several tasks or sets of arms.
    """
    left_out: Counter[str] = Counter()
    taken: list[LabelledEpisode] = []
    for row in chosen:
        why = COUNTED.why_not(row)
        if why:
            left_out[why] += 1
        else:
            taken.append(row)
    if not taken:
        raise InvalidInput(
            f"Nothing was put into {name!r}: {_counted(left_out)}; choose episodes to learn from."
        )
    members = [row for row in known if name in row.datasets]
    advice = "a data set holds one: narrow the choice, or use another name"
    require_alike([*members, *taken], advice, any_rate=True)
    said = labels.read_folded(root)
    return _act(root, name, datasets.join(said, name, [row.path for row in taken], now_ns, by), left_out)


def take_out(root: Path, name: str, paths: Iterable[str], now_ns: int, by: str = "") -> DataSetEdit:
    """Take the episodes with these paths out of a data set. Raises NotFound where there is no such data set."""
    said = labels.read_folded(root)
    datasets.find(said, name)
    return _act(root, name, datasets.leave(said, name, paths, now_ns, by))


def undo(root: Path, name: str, act_ns: int, now_ns: int, by: str = "") -> DataSetEdit:
    """Take back what was done to a data set at `act_ns`. Raises NotFound where nothing was done to it then."""
    opposite = datasets.undo(labels.read(root), name, act_ns, now_ns, by)
    if not opposite:
        raise NotFound(
            f"Nothing was done to the data set {name[:100]!r} at {act_ns}, so nothing can be undone."
        )
    return _act(root, name, opposite)


def _act(root: Path, name: str, said: list[Label], left_out: Mapping[str, int] | None = None) -> DataSetEdit:
    act_ns = labels.append(root, said)
    now = datasets.named(labels.read_folded(root)).get(name, NamedDataSet(name, (), 0))
    return DataSetEdit(now, len(said), act_ns, dict(left_out or {}))


def _counted(left_out: Mapping[str, int]) -> str:
    return ", ".join(f"{count} {why}" for why, count in sorted(left_out.items())) or "no episode was chosen"
