"""docs/tasks.md says what the catalogue says: `make task-pages` writes it anew."""

from __future__ import annotations

from mart.protocol.tasks import task_names
from tools import task_pages


def test_the_page_is_fresh() -> None:
    assert (task_pages.DOCS / "tasks.md").read_text() == task_pages.page() + "\n"


def test_its_pictures_exist() -> None:
    assert (task_pages.DOCS / task_pages.SHEET).stat().st_size > 100_000
    assert {path.stem for path in task_pages.PICTURES.iterdir()} == set(task_names())
