"""Leave out the pieces of an episode that is whole in another file: a recorder that was killed leaves them.

The next one asks the room for what it missed, and so it records the whole episode all the same.
"""

from __future__ import annotations

from pathlib import Path

from mart.episodes import find_episodes, labels
from mart.protocol.recording import EpisodeRecord

_SLACK_NS = 1_000_000_000


def drop_pieces(root: Path, room: str, number: int, at_ns: int) -> list[Path]:
    """Label as dropped each piece of an episode whose ticks a whole file of it holds too; return these pieces.

    root: the folder of episodes. at_ns: Unix time of the label.
    """
    found = [one for one in find_episodes(root, room, number) if one.error is None and not one.dropped]
    files = {one.file_path: one.open().episode for one in found}
    dropped = []
    for path, piece in files.items():
        holder = next((other for other, whole in files.items() if _holds(whole, piece)), None)
        if holder is not None:
            detail = f"All of it is in {holder.name}."
            labels.say(path, labels.LabelKind.USE, labels.DROP, at_ns, detail)
            dropped.append(path)
    return dropped


def _holds(whole: EpisodeRecord, piece: EpisodeRecord) -> bool:
    return (
        whole.complete
        and not piece.complete
        and whole.first_tick <= piece.first_tick <= piece.last_tick <= whole.last_tick
        and whole.started_ns - _SLACK_NS <= piece.started_ns <= piece.ended_ns <= whole.ended_ns + _SLACK_NS
    )
