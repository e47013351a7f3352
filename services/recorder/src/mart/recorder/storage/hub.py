"""Bring an export to a hub as a data set of its own there: huggingface.co, or whatever HF_ENDPOINT names.

Who one is there, huggingface_hub finds out itself (HF_TOKEN, or `hf auth login`); no token passes through here.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, NotFound, Unavailable

if TYPE_CHECKING:
    from huggingface_hub import HfApi
    from huggingface_hub.hf_api import RepoFile

_TYPE = "dataset"
_SCHEME = "hf://datasets/"
_THE_HUBS_OWN = ".gitattributes"
_FILES_A_COMMIT = 1000
_MAX_REASON_CHARACTERS = 300
_NOT_YOURS = (401, 403)


@dataclass(frozen=True)
class HubTarget:
    """Say where on a hub an export goes.

    repo: OWNER/NAME. public: whether everybody may read what is made there; a data set that is there stays as it is.
    over: whether what it holds is replaced; its history keeps that.
    """

    repo: str
    public: bool = False
    over: bool = False

    @classmethod
    def of_url(cls, url: str, *, public: bool, over: bool) -> HubTarget | None:
        """Read hf://datasets/OWNER/NAME; None for the URL of any other store."""
        return cls(url.removeprefix(_SCHEME), public, over) if url.startswith(_SCHEME) else None


def require_reachable(target: HubTarget) -> None:
    """Raise what `push_export` would raise for this target now, whatever is to be pushed.

    Raises Conflict where the data set holds anything and may not be replaced: ask before an export takes its time.
    """
    with _asking(target.repo):
        there = _files_there(_hub(), target.repo)
    if there and not target.over:
        raise _taken(target.repo, [*there])


def push_export(path: Path, target: HubTarget) -> str:
    """Bring an export to the hub, a folder or an HDF5 file with its card, and return the address of the data set.

    Begun again after an interruption it goes on. Raises Conflict where the data set holds anything else, InvalidInput
    for a name that no data set can have and where huggingface_hub is not installed, Forbidden where one may not write
    there, Unavailable where the hub cannot be reached, and NotFound where there is no such export.
    """
    files = _files_of(path)
    with _asking(target.repo):
        api = _hub()
        there = _files_there(api, target.repo)
        same = {name for name, file in files.items() if name in there and _is_same(there[name], file)}
        other = sorted(there.keys() - same)
        if other and not target.over:
            raise _taken(target.repo, other)
        made = api.create_repo(target.repo, repo_type=_TYPE, private=not target.public, exist_ok=True)
        _commit(
            api,
            target.repo,
            {name: files[name] for name in files if name not in same},
            there.keys() - files.keys(),
        )
        _tag(api, target.repo, path)
    return str(made)


def _files_of(path: Path) -> dict[str, Path]:
    """Return by its name on the hub each file of an export; a hub shows README.md as what a data set is."""
    if path.is_dir():
        found = {one.relative_to(path).as_posix(): one for one in sorted(path.rglob("*")) if one.is_file()}
    elif path.is_file():
        card = path.with_suffix(".md")
        found = {path.name: path} | ({"README.md": card} if card.is_file() else {})
    else:
        found = {}
    if "README.md" not in found:
        raise NotFound(f"{path} is no export with its data card; `mart episodes export` makes one.")
    return found


def _hub() -> HfApi:
    from huggingface_hub import HfApi
    from huggingface_hub.utils.tqdm import disable_progress_bars

    disable_progress_bars()
    return HfApi(endpoint=os.environ.get("HF_ENDPOINT"), library_name="mart")


def _files_there(api: HfApi, repo: str) -> dict[str, RepoFile]:
    """Return by name what a data set holds, but for what the hub puts into each; nothing where there is none."""
    from huggingface_hub.errors import EntryNotFoundError, RepositoryNotFoundError
    from huggingface_hub.hf_api import RepoFile

    try:
        entries = [*api.list_repo_tree(repo, recursive=True, repo_type=_TYPE)]
    except (RepositoryNotFoundError, EntryNotFoundError):
        return {}
    return {one.path: one for one in entries if isinstance(one, RepoFile) and one.path != _THE_HUBS_OWN}


def _is_same(there: RepoFile, file: Path) -> bool:
    size_bytes = file.stat().st_size
    if there.size != size_bytes:
        return False
    if there.lfs is not None:
        with file.open("rb") as source:
            return hashlib.file_digest(source, "sha256").hexdigest() == there.lfs.sha256
    blob = hashlib.sha1(b"blob %d\0" % size_bytes, usedforsecurity=False)  # how git names what it holds
    blob.update(file.read_bytes())
    return blob.hexdigest() == there.blob_id


def _commit(api: HfApi, repo: str, files: Mapping[str, Path], stale: set[str]) -> None:
    from huggingface_hub import CommitOperationAdd, CommitOperationCopy, CommitOperationDelete

    operations: list[CommitOperationAdd | CommitOperationCopy | CommitOperationDelete] = [
        *(CommitOperationDelete(path_in_repo=name) for name in sorted(stale)),
        *(CommitOperationAdd(path_in_repo=name, path_or_fileobj=file) for name, file in files.items()),
    ]
    for first in range(0, len(operations), _FILES_A_COMMIT):
        some = operations[first : first + _FILES_A_COMMIT]
        message = f"Export of MART, {len(some)} files"
        api.create_commit(repo, some, commit_message=message, repo_type=_TYPE)


def _tag(api: HfApi, repo: str, path: Path) -> None:
    """Name the version of the format, by which LeRobot loads; the newest export has the name."""
    from huggingface_hub.errors import RevisionNotFoundError

    from mart.recorder.export.lerobot import VERSION

    if not path.is_dir():
        return
    with suppress(RevisionNotFoundError):
        api.delete_tag(repo, tag=VERSION, repo_type=_TYPE)
    api.create_tag(repo, tag=VERSION, repo_type=_TYPE)


def _taken(repo: str, names: list[str]) -> Conflict:
    return Conflict(
        f"The data set {repo} holds {len(names)} files of something else, such as {names[0][:100]}; name another one, "
        "or give --push-over to replace them (its history keeps them)."
    )


@contextmanager
def _asking(repo: str) -> Iterator[None]:
    """Say in a sentence what a hub answers, without anything that was sent to it."""
    try:
        from httpx2 import HTTPError
        from huggingface_hub.errors import HfHubHTTPError, HFValidationError, LocalTokenNotFoundError
    except ImportError as error:
        raise InvalidInput("A hub needs a package: pip install 'mart-recorder[hub]'.") from error
    wrong = f"{repo[:200]!r} names no data set on a hub; give OWNER/NAME."
    if repo.count("/") != 1:
        raise InvalidInput(wrong)
    try:
        yield
    except HFValidationError as error:
        raise InvalidInput(wrong) from error
    except LocalTokenNotFoundError as error:
        raise Forbidden(_WHO) from error
    except HfHubHTTPError as error:
        status = error.response.status_code
        if status in _NOT_YOURS:
            raise Forbidden(f"You may not write to the data set {repo} (HTTP {status}). {_WHO}") from error
        raise Unavailable(f"The hub refused {repo}: HTTP {status}: {_short(error.server_message)}") from error
    except (HTTPError, OSError, RuntimeError, ValueError) as error:  # what it raises where an upload fails
        raise Unavailable(f"The hub cannot be reached for {repo}: {_short(str(error))}") from error


_WHO = "Log in with `hf auth login`, or set HF_TOKEN to a token that may write there."


def _short(text: str | None) -> str:
    return (text or "no reason was given").splitlines()[0][:_MAX_REASON_CHARACTERS]
