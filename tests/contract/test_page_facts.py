"""What the pages know from the Python parts is what those say: `make page-facts` writes it anew."""

from __future__ import annotations

from tools import page_facts


def test_what_the_pages_know_is_fresh() -> None:
    files = page_facts.files()
    assert {path: path.read_text() for path in files} == files
