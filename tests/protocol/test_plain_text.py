from __future__ import annotations

import pytest

from mart.protocol.errors import InvalidInput
from mart.protocol.plain_text import require_path, require_plain


@pytest.mark.parametrize("given", ["", "episodes/2026-11-22", "Zoë’s \u00a0 notes", "/abs/x.mcap"])
def test_what_people_write_is_taken(given: str) -> None:
    assert require_plain("note", given) == require_path("path", given) == given


@pytest.mark.parametrize("given", ["a\0b", "a\nb", "\x7f", "\x9b31m"])
def test_control_characters_are_not(given: str) -> None:
    with pytest.raises(InvalidInput):
        require_plain("note", given)
    with pytest.raises(InvalidInput):
        require_path("path", given)


@pytest.mark.parametrize("given", ["x" * 256, "a/" + "ü" * 128])
def test_a_name_longer_than_any_file_system_has_names_no_file(given: str) -> None:
    with pytest.raises(InvalidInput):
        require_path("path", given)
