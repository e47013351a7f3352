"""What cannot be multiplied is refused, in a sentence that says what to do."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.recorder.multiply.sources import read_sources
from tests.recorder.files import write_episode

TASK = "two_arm_multi_cube_lifting"


def test_a_folder_without_a_success_has_nothing_to_multiply(tmp_path: Path) -> None:
    write_episode(tmp_path)
    with pytest.raises(InvalidInput) as refused:
        read_sources([tmp_path], "two_arm_drink_tray_lifting", None, from_generated=False)
    assert "0 of two_arm_drink_tray_lifting were found" in str(refused.value)


def test_a_path_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        read_sources([tmp_path / "nowhere"], TASK, None, from_generated=False)
