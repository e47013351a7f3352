"""Reach a folder in a store by its URL (file, memory, S3 and whatever else fsspec knows): digests and new files.

Beside each file lies one of its digest, `NAME.sha256`, written last. Nothing that is there is ever overwritten.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import fsspec
from fsspec.implementations.local import LocalFileSystem

from mart.protocol.errors import Conflict, Corrupt, InvalidInput, MartError, Unavailable
from mart.runtime.atomic_file import rename_to_new

DIGEST_SUFFIX = ".sha256"
PIECE_BYTES = 1024 * 1024
_SHA256 = re.compile(rb"[0-9a-f]{64}")
_MAX_REASON_CHARACTERS = 300


@dataclass(frozen=True)
class Store:
    """A folder in a store. name: its URL as people may see it. root: the folder, as its file system names it."""

    name: str
    files: Any
    root: str

    @classmethod
    def open(cls, url: str, endpoint_url: str = "") -> Store:
        """Reach the store of a URL; who one is there, the environment says.

        endpoint_url: of an S3 that is not Amazon's.
        Raises InvalidInput for a URL that cannot be used, or one that holds a password.
        """
        scheme, _, rest = url.partition("://")
        if not rest or "@" in rest.partition("/")[0]:
            raise InvalidInput(
                "Give a URL such as s3://bucket/folder or file:///folder, without a name or password; those come from "
                "the environment (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY)."
            )
        options = {"endpoint_url": endpoint_url} if endpoint_url else {}
        if scheme == "file":
            options = {"auto_mkdir": True}  # type: ignore[dict-item]
        try:
            files, root = fsspec.core.url_to_fs(url, use_listings_cache=False, **options)
        except ImportError as error:
            raise InvalidInput(f"{scheme}:// needs a package: pip install 'mart-recorder[s3]'.") from error
        except (ValueError, TypeError) as error:
            raise InvalidInput(f"{scheme}:// cannot be used: {error}.") from error
        return cls(url, files, root.rstrip("/"))

    def key(self, name: str) -> str:
        """Return what the file system calls the file `name` below this folder."""
        return f"{self.root}/{name}"

    def sizes(self) -> dict[str, int]:
        """Return the size of each file below the folder, by name."""
        with reaching(self.name):
            try:
                found = self.files.find(self.root, detail=True)
            except FileNotFoundError:
                return {}
        start = len(self.root) + 1
        return {key[start:]: int(facts["size"]) for key, facts in found.items()}

    def read(self, name: str, most_bytes: int) -> bytes:
        """Return a small file whole. Raises Corrupt for one of more than `most_bytes`."""
        with reaching(self.name), self.files.open(self.key(name), "rb") as file:
            data: bytes = file.read(most_bytes + 1)
        if len(data) > most_bytes:
            raise Corrupt(
                f"{name} in {self.name} has more than {most_bytes} bytes, which nothing of MART's has."
            )
        return data

    def digest(self, name: str) -> str:
        """Return the SHA-256 of a file as it is there, read whole."""
        with reaching(self.name), self.files.open(self.key(name), "rb") as file:
            return digest_of(file)

    def said_digest(self, name: str) -> str | None:
        """Return the digest that lies beside a file; None where none does, or nothing that is one."""
        try:
            with reaching(self.name), self.files.open(self.key(name + DIGEST_SUFFIX), "rb") as file:
                said = file.read(65)[:64]
        except FileNotFoundError:
            return None
        return said.decode() if _SHA256.fullmatch(said) else None

    def put(self, source: Path, name: str) -> str:
        """Bring a file into the store under a name that nothing has, read back whole; return its digest.

        Raises Conflict where the name is taken, and Corrupt where what arrived is not what was sent.
        """
        with source.open("rb") as file:
            digest = digest_of(file)
        with reaching(self.name):
            try:
                self._create(source, name, digest)
            except FileExistsError as error:
                # The same file: a request whose answer was lost is sent again, and finds what it made itself.
                if self.digest(name) != digest:
                    raise Conflict(
                        f"{name} is in {self.name} by now, from somebody else; push again."
                    ) from error
        if self.digest(name) != digest:
            raise Corrupt(
                f"{name} in {self.name} is not what {source} holds; delete it there and push again."
            )
        self.say_digest(name, digest)
        return digest

    def say_digest(self, name: str, digest: str) -> None:
        """Write the digest of a file beside it: that it is whole."""
        with reaching(self.name):
            self.files.pipe_file(
                self.key(name + DIGEST_SUFFIX), f"{digest}  {name.rpartition('/')[2]}\n".encode()
            )

    def _create(self, source: Path, name: str, digest: str) -> None:
        if not isinstance(self.files, LocalFileSystem):
            self.files.put_file(str(source), self.key(name), mode="create")  # stores show whole objects alone
            return
        target = Path(self.key(name))
        target.parent.mkdir(parents=True, exist_ok=True)
        draft = target.with_name(f".{target.name}.{uuid.uuid4().hex}")
        try:
            shutil.copyfile(source, draft)
            with draft.open("rb") as file:
                if digest_of(file) != digest:
                    raise Corrupt(f"{source} changed while it was copied; push again.")
            rename_to_new(draft, target)
        finally:
            draft.unlink(missing_ok=True)


def digest_of(file: BinaryIO) -> str:
    """Return the SHA-256 of the rest of a file."""
    digest = hashlib.sha256()
    while piece := file.read(PIECE_BYTES):
        digest.update(piece)
    return digest.hexdigest()


@contextmanager
def reaching(store: str) -> Iterator[None]:
    """Say in a sentence what a store answers. Raises Unavailable; FileNotFoundError and FileExistsError pass."""
    try:
        yield
    except (MartError, FileNotFoundError, FileExistsError):
        raise
    except Exception as error:  # each kind of store raises errors of its own
        why = str(error)[:_MAX_REASON_CHARACTERS]
        raise Unavailable(f"{store} cannot be used: {type(error).__name__}: {why}") from error
