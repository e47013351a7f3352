"""Hooks of the documentation site, `make docs`: files from outside docs/, links that hold, the list of decisions."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
DOCS = "docs"

# Globs of files that stand elsewhere in the repository, and the site's folder for them.
_BORROWED = {
    "CHANGELOG.md": "",
    "CONTRIBUTING.md": "",
    "services/web/src/mart/web/static/icon.svg": "images",
    "services/web/src/mart/web/static/tasks/*.jpg": "images/tasks",
}
_DECISIONS = "decisions/*.md"
_TARGET = re.compile(r"\]\((?!\w+:|#)([^)#\s]+)")
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!\w+:|#)([^)#\s]+)(?:#[^)\s]*)?\)")
_FILE_BLOCK = re.compile(r"^```python file=(\S+)$", re.MULTILINE)


def on_config(config: MkDocsConfig) -> None:
    """Put every decision into the navigation, in the place where it says `decisions/*.md`."""
    config.nav = _with_decisions(config.nav)


def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add the files that stand elsewhere in the repository."""
    for source, on_site in _borrowed():
        files.append(File.generated(config, on_site, abs_src_path=str(ROOT / source)))


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links to the repository's files into links to the site's, and paths of code blocks into titles.

    A link to a file that is not on the site keeps its words alone. One that leads nowhere stays: MkDocs complains.
    """
    at = page.file.src_uri
    folder = posixpath.dirname(
        next((source for source, on_site in _borrowed() if on_site == at), f"{DOCS}/{at}")
    )

    def on_site(target: str) -> str | None:
        source = posixpath.normpath(posixpath.join(folder, target))
        moved = dict(_borrowed()).get(source, source.removeprefix(f"{DOCS}/"))
        candidates = (moved, posixpath.join(moved, "README.md"))
        found = next((name for name in candidates if files.get_file_from_path(name) is not None), None)
        return found and posixpath.relpath(found, posixpath.dirname(at) or ".")

    def without_link(match: re.Match[str]) -> str:
        elsewhere = on_site(match[2]) is None and (ROOT / folder / match[2]).exists()
        return match[1] if elsewhere else match[0]

    text = _LINK.sub(without_link, markdown)
    text = _TARGET.sub(lambda match: f"]({on_site(match[1]) or match[1]}", text)
    return _FILE_BLOCK.sub(r'```python title="\1"', text)


def _borrowed() -> Iterator[tuple[str, str]]:
    """Yield the repository's path and the site's path of every borrowed file."""
    for glob, folder in _BORROWED.items():
        for path in sorted(ROOT.glob(glob)):
            yield str(path.relative_to(ROOT)), posixpath.join(folder, path.name)


def _with_decisions(nav: Any) -> Any:
    match nav:
        case dict():
            return {title: _with_decisions(part) for title, part in nav.items()}
        case list():
            return [one for part in nav for one in _spread(part)]
        case _:
            return nav


def _spread(part: Any) -> Iterator[Any]:
    if part == _DECISIONS:
        yield from (
            f"decisions/{path.name}" for path in sorted((ROOT / DOCS / "decisions").glob("[0-9]*.md"))
        )
    else:
        yield _with_decisions(part)
