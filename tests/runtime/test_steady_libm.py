"""Fused multiply-add is switched off for a process before it begins, and nothing else is."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.runtime import steady_libm
from mart.runtime.steady_libm import GIVEN, TUNABLES, native_environment, steady, steady_environment

_WORDS = st.sampled_from(["-AVX2", "AVX2", "-FMA", "FMA", "-FMA4", "Prefer_ERMS"])
_OTHERS = st.sampled_from(["glibc.malloc.check=1", "glibc.pthread.rseq=0", "glibc.malloc.check=2"])
_TUNABLES = st.lists(
    st.one_of(_OTHERS, st.lists(_WORDS).map(lambda words: f"glibc.cpu.hwcaps={','.join(words)}"))
).map(":".join)


@given(tunables=_TUNABLES)
def test_it_is_off_and_whatever_else_was_set_stays(tunables: str) -> None:
    pairs = [pair.split("=") for pair in steady(tunables).split(":")]
    (words,) = (value.split(",") for name, value in pairs if name == "glibc.cpu.hwcaps")
    assert {"-FMA", "-FMA4"} <= set(words)
    given_words = [
        w for pair in tunables.split(":") if "hwcaps" in pair for w in pair.split("=")[1].split(",")
    ]
    assert {w for w in given_words if w and "FMA" not in w} == {w for w in words if "FMA" not in w}
    others = [f"{name}={value}" for name, value in pairs if name != "glibc.cpu.hwcaps"]
    assert others == [pair for pair in tunables.split(":") if pair and "hwcaps" not in pair]
    assert steady(steady(tunables)) == steady(tunables)


def test_a_value_that_has_it_off_is_left_as_it_is() -> None:
    said = "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX,-FMA4"
    assert steady(said) == said


def test_what_was_given_is_kept_for_those_who_want_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steady_libm, "is_needed", lambda: True)
    begun = steady_environment({TUNABLES: "glibc.malloc.check=1", "HOME": "/"})
    assert begun is not None
    assert begun[TUNABLES] == "glibc.malloc.check=1:glibc.cpu.hwcaps=-FMA,-FMA4"
    assert native_environment(begun) == {TUNABLES: "glibc.malloc.check=1"}
    assert steady_environment(begun) is None
    assert native_environment({}) is None


def test_elsewhere_nothing_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steady_libm, "is_needed", lambda: False)
    assert steady_environment({}) is None


@pytest.mark.system
def test_a_command_begins_anew_with_it(tmp_path: Path) -> None:
    program = (
        "import os, sys; from mart.runtime.steady_libm import begin_anew; begin_anew(); print(os.environ.get"
    )
    program += f"('{TUNABLES}'), os.environ.get('{GIVEN}'), sys.argv[1:])"
    script = tmp_path / "command.py"
    script.write_text(program)
    clean = {name: value for name, value in os.environ.items() if name not in (TUNABLES, GIVEN)}
    command = [sys.executable, str(script), "a b", "--c"]
    said = subprocess.run(command, env=clean, capture_output=True, text=True, check=True).stdout.strip()
    off = "glibc.cpu.hwcaps=-FMA,-FMA4 " if steady_libm.is_needed() else "None None"
    assert said.startswith(off)
    assert said.endswith("['a b', '--c']")
