"""Cameras are named on every command the same way, and no refusal repeats an address."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from mart.protocol.errors import InvalidInput
from mart.runtime.camera_option import cameras_option


def given(*words: str) -> dict[str, str]:
    chosen: dict[str, str] = {}

    @click.command()
    @cameras_option
    def command(cameras: dict[str, str]) -> None:
        chosen.update(cameras)

    result = CliRunner().invoke(command, [part for word in words for part in ("--camera", word)])
    if isinstance(result.exception, InvalidInput):
        raise result.exception
    assert result.exit_code == 0, result.output
    return chosen


def test_names_with_and_without_a_source() -> None:
    assert given("arm0=0", "arm0.wrist=rtsp://h/x?a=b", "table") == {
        "arm0": "0",
        "arm0-wrist": "rtsp://h/x?a=b",
        "table": "",
    }


@pytest.mark.parametrize(
    "words",
    [
        ("rtsp://ana:geheim@h/x",),
        ("arm0=rtsp://ana:geheim@h/x", "arm0=1"),
        tuple(f"table{number}=rtsp://ana:geheim@h" for number in range(13)),
    ],
)
def test_a_refusal_repeats_no_address(words: tuple[str, ...]) -> None:
    with pytest.raises(InvalidInput) as refused:
        given(*words)
    assert "geheim" not in str(refused.value)
