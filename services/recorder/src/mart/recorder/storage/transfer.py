"""Push finished files to a store and pull them back, each checked whole; what is there already stays as it is."""

from __future__ import annotations

import hashlib
import os
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mart.episodes import labels
from mart.episodes.folder import episode_files
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Conflict, Corrupt, InvalidInput, NotFound
from mart.protocol.recording import SUFFIX
from mart.recorder.storage.label_lines import is_labels, pull_lines, push_lines
from mart.recorder.storage.store import DIGEST_SUFFIX, PIECE_BYTES, Store, digest_of, reaching
from mart.runtime.atomic_file import rename_to_new, sync_folder

_MAX_FILES = 100_000
_MAX_FILE_BYTES = 64 * 1024**3
_MAX_NAME_CHARACTERS = 1024


@dataclass
class Transferred:
    """Tell what went over. files: those that are new there. there: how many were there. labels: new lines."""

    files: list[str] = field(default_factory=list)
    there: int = 0
    bytes: int = 0
    labels: int = 0


def to_push(paths: list[Path]) -> dict[str, Path]:
    """Return what is to be pushed, by its name in the store.

    Episodes are named as labels name them; of a folder without episodes, an export say, every file is, below its name.
    Raises NotFound for a path that is not there, and Conflict where two files would have one name.
    """
    found: dict[str, Path] = {}
    for path in paths:
        for name, file in _named(path):
            other = found.setdefault(name, file)
            if labels.resolved(other) != labels.resolved(file):
                raise Conflict(
                    f"{other} and {file} would both be {name} in the store; push them to two URLs."
                )
    if not found:
        raise NotFound("There are no finished episodes to push; name files or folders.")
    return found


def push(files: Mapping[str, Path], store: Store, after_each: Callable[[], None]) -> Transferred:
    """Bring files into a store, and what was said about the episodes among them.

    Raises Conflict where the store has another file of a name: nothing more is pushed then.
    """
    known, done = store.sizes(), Transferred()
    for name, source in files.items():
        if name in known:
            _require_same(store, name, source, known[name], f"{name} in {store.name}")
            done.there += 1
        else:
            store.put(source, name)
            done.files.append(name)
            done.bytes += source.stat().st_size
        after_each()
    by_root: dict[Path, set[str]] = {}
    for name, source in files.items():
        if source.name.endswith(SUFFIX):
            by_root.setdefault(labels.root_of(source), set()).add(name)
    done.labels = sum(push_lines(store, store.sizes(), root, names) for root, names in by_root.items())
    return done


def to_pull(store: Store) -> dict[str, int]:
    """Return the sizes of the files that can be pulled, by name.

    Raises NotFound for an empty store, and InvalidInput for one with too many files, too large ones, or names that lead
    elsewhere.
    """
    found = {
        name: size
        for name, size in store.sizes().items()
        if not (is_labels(name) or name.endswith(DIGEST_SUFFIX) or name.rpartition("/")[2].startswith("."))
    }
    if not found:
        raise NotFound(f"There is nothing to pull in {store.name}.")
    if len(found) > _MAX_FILES:
        raise InvalidInput(f"{store.name} holds {len(found)} files; {_MAX_FILES} can be pulled at once.")
    for name, size in found.items():
        _require_name(name)
        if size > _MAX_FILE_BYTES:
            raise InvalidInput(f"{name[:200]} has {size} bytes; {_MAX_FILE_BYTES} are allowed.")
    return found


def pull(sizes: Mapping[str, int], store: Store, out: Path, after_each: Callable[[], None]) -> Transferred:
    """Fetch files into the folder `out`, and what is said about the episodes among them.

    Each is checked before it gets its name. Raises Corrupt where one is not whole, and Conflict where `out` has
    another.
    """
    done = Transferred()
    for name, size in sizes.items():
        target = _inside(out, name)
        if not target.exists() and _fetch(store, name, size, target):
            done.files.append(name)
            done.bytes += size
        else:
            _require_same(store, name, target, size, str(target))
            done.there += 1
        after_each()
    done.labels = pull_lines(store, store.sizes(), out)
    return done


def _named(path: Path) -> list[tuple[str, Path]]:
    episodes = [one for one in episode_files([path]) if one.is_file()]
    if episodes:
        return [(labels.resolved(one).relative_to(labels.root_of(one)).as_posix(), one) for one in episodes]
    files = sorted(one for one in path.rglob("*") if one.is_file() and not one.is_symlink())
    below = path.resolve()
    return [(f"{below.name}/{one.relative_to(path).as_posix()}", one) for one in files if one.name[0] != "."]


def _require_same(store: Store, name: str, here: Path, size: int, taken: str) -> None:
    if here.stat().st_size == size:
        with here.open("rb") as file:
            digest = digest_of(file)
        said = store.said_digest(name)
        if digest == said:
            return
        if said is None and store.digest(name) == digest:  # whoever pushed it was stopped before saying so
            store.say_digest(name, digest)
            return
    raise Conflict(
        f"{taken} is there and differs from the other ({here}, {store.name}); rename one. Both stay."
    )


def _fetch(store: Store, name: str, size: int, target: Path) -> bool:
    """Fetch a file, and tell whether it got its name: not where somebody else has pulled it meanwhile."""
    target.parent.mkdir(parents=True, exist_ok=True)
    draft = target.with_name(f".{target.name[:100]}.{uuid.uuid4().hex}")
    try:
        digest, got = hashlib.sha256(), 0
        with (
            reaching(store.name),
            store.files.open(store.key(name), "rb") as source,
            draft.open("xb") as file,
        ):
            while got <= size and (piece := source.read(PIECE_BYTES)):
                got += len(piece)
                digest.update(piece)
                file.write(piece)
        said = store.said_digest(name)
        if got != size or (said is not None and said != digest.hexdigest()):
            raise Corrupt(
                f"{name} in {store.name} is not whole, so it was not kept; push it again from where it is."
            )
        if name.endswith(SUFFIX):
            EpisodeFile.open(draft).check()
        elif said is None:
            raise Corrupt(
                f"{name} in {store.name} has no digest beside it; push it again to say that it is whole."
            )
        with draft.open("rb") as file:
            os.fsync(file.fileno())
        rename_to_new(draft, target)
        sync_folder(target.parent)
    except FileExistsError:
        return False
    finally:
        draft.unlink(missing_ok=True)
    return True


def _require_name(name: str) -> None:
    parts = name.split("/")
    if (
        not name.isprintable()
        or "\\" in name
        or len(name) > _MAX_NAME_CHARACTERS
        or any(part in ("", ".", "..") for part in parts)
    ):
        raise InvalidInput(f"The store names a file {name[:200]!r}, which cannot be one below the folder.")


def _inside(out: Path, name: str) -> Path:
    target = out / name
    if not target.resolve().is_relative_to(out.resolve()):
        raise InvalidInput(f"{target} leads out of {out} by a link; take that away, or pull elsewhere.")
    return target
