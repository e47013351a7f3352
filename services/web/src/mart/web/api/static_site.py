"""Hold the pages' files so that a page comes in one round trip, and again without any.

Files are addressed below a digest of them all, so browsers may keep them for ever: another version has other addresses.
Modules import each other by relative addresses and stay below the digest that the page named. A page names every module
that it needs before it runs (`modulepreload`), or a browser would find them one round trip after another. Texts are
packed once.
"""

from __future__ import annotations

import gzip
import hashlib
import mimetypes
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path, PurePosixPath
from posixpath import normpath

PREFIX = "/static/"
_DIGEST_CHARACTERS = 16
_PACKED_SUFFIXES = (".css", ".html", ".js", ".svg")
_IMPORT = re.compile(r'^(?:import|export)\b[^;"\']*["\'](\.[^"\']+)["\'];', re.MULTILINE)
_ENTRY = re.compile(r'<script type="module" src="/static/([^"]+)"></script>')
_STYLE = re.compile(r'<link rel="stylesheet" href="/static/([^"]+)"')


@dataclass(frozen=True)
class StaticFile:
    """Hold one file: its content, what it is, and where packing helps the packed content."""

    name: str
    content: bytes

    @property
    def media_type(self) -> str:
        """Its media type, as browsers call it."""
        return mimetypes.guess_type(self.name)[0] or "application/octet-stream"

    @cached_property
    def packed(self) -> bytes | None:
        """The content as gzip, or None where that would not be shorter by much."""
        if not self.name.endswith(_PACKED_SUFFIXES):
            return None
        return gzip.compress(self.content, mtime=0)


@dataclass(frozen=True)
class StaticSite:
    """Hold all files of a folder by their names below it; `prefetched`: pages by the page that leads to them."""

    files: Mapping[str, StaticFile]
    prefetched: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, folder: Path, prefetched: Mapping[str, str] | None = None) -> StaticSite:
        """Read a folder; what changes in it afterwards is not seen."""
        paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
        names = {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}
        files = {name: StaticFile(name, content) for name, content in names.items()}
        return cls(files, prefetched or {})

    @cached_property
    def digest(self) -> str:
        """What tells this version from all others, in hexadecimal digits."""
        digest = hashlib.sha256()
        for name, file in sorted(self.files.items()):
            digest.update(f"{name}\0{len(file.content)}\0".encode() + file.content)
        return digest.hexdigest()[:_DIGEST_CHARACTERS]

    def find(self, path: str) -> tuple[StaticFile, bool] | None:
        """Return the file at `path` below PREFIX, with or without a digest, or None where there is none.

        The second value tells whether browsers may keep it: under the digest of another version they may not.
        """
        if path in self.files:
            return self.files[path], False
        digest, _, name = path.partition("/")
        is_digest = len(digest) == _DIGEST_CHARACTERS and set(digest) <= set("0123456789abcdef")
        if not is_digest or name not in self.files:
            return None
        return self.files[name], digest == self.digest

    def page(self, name: str) -> StaticFile:
        """Return the page `name` with the addresses of this version, and what it needs named ahead."""
        return self._pages[name]

    @cached_property
    def _pages(self) -> dict[str, StaticFile]:
        names = (name for name in self.files if name.endswith(".html") and "/" not in name)
        return {name.removesuffix(".html"): StaticFile(name, self._page(name)) for name in names}

    def _page(self, file_name: str) -> bytes:
        name = file_name.removesuffix(".html")
        text = self._text(file_name)
        links = [("modulepreload", module) for module in self.modules_of(name)]
        following = self.prefetched.get(name)
        if following is not None:
            links += [("prefetch", needed) for needed in self._needed_beside(following, name)]
        lines = "".join(f'    <link rel="{rel}" href="{PREFIX}{path}" />\n' for rel, path in links)
        head, end, rest = text.partition("  </head>")
        return f"{head}{lines}{end}{rest}".replace(f'"{PREFIX}', f'"{PREFIX}{self.digest}/').encode()

    def _needed_beside(self, page: str, shown: str) -> Iterator[str]:
        known = {*self._styles_of(shown), *self.modules_of(shown)}
        yield from (one for one in (*self._styles_of(page), *self.modules_of(page)) if one not in known)

    def _styles_of(self, page: str) -> list[str]:
        return _STYLE.findall(self._text(f"{page}.html"))

    def modules_of(self, page: str) -> list[str]:
        """Return the names of all modules that a page runs, each once, entries first."""
        found: list[str] = []
        left = _ENTRY.findall(self._text(f"{page}.html"))
        while left:
            module = left.pop(0)
            if module not in found:
                found.append(module)
                left += self._imports_of(module)
        return found

    def _imports_of(self, module: str) -> list[str]:
        folder = PurePosixPath(module).parent
        return [normpath(str(folder / target)) for target in _IMPORT.findall(self._text(module))]

    def _text(self, name: str) -> str:
        return self.files[name].content.decode()
