"""Keep the C library's mathematics the same on every x86-64 processor, so that a world steps to the same bits on each.

glibc chooses variants of sin, exp and others by what the processor can do, and those with fused multiply-add (FMA,
FMA4) round differently. They are switched off by `GLIBC_TUNABLES`, which is read before a process begins and never
again: a command that began with them begins anew. What a user has set there besides stays. Elsewhere (another
processor, another C library) nothing is done.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping

TUNABLES = "GLIBC_TUNABLES"
GIVEN = "GLIBC_TUNABLES_BEFORE_MART"  # what TUNABLES was, empty where it was not set
_HWCAPS = "glibc.cpu.hwcaps"
_OFF = ("-FMA", "-FMA4")


def steady(tunables: str) -> str:
    """Return the value of `GLIBC_TUNABLES` with fused multiply-add switched off, and all else that it says kept.

    >>> steady("glibc.malloc.check=1:glibc.cpu.hwcaps=-AVX2")
    'glibc.malloc.check=1:glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4'
    """
    pairs = [pair.partition("=") for pair in tunables.split(":") if pair]
    said = [word for name, _, value in pairs if name == _HWCAPS for word in value.split(",") if word]
    others = [f"{name}={value}" for name, _, value in pairs if name != _HWCAPS]
    kept = [word for word in said if word.lstrip("+-") not in {off.lstrip("-") for off in _OFF}]
    words = said if set(_OFF) <= set(said) else [*kept, *_OFF]
    return ":".join([*others, f"{_HWCAPS}={','.join(words)}"])


def is_needed() -> bool:
    """Whether this is a processor and a C library whose results depend on the processor."""
    return os.uname().machine == "x86_64" and "CS_GNU_LIBC_VERSION" in os.confstr_names


def steady_environment(environment: Mapping[str, str]) -> dict[str, str] | None:
    """Return the environment that a process must begin with; None where it has it already, or none is needed."""
    given = environment.get(TUNABLES, "")
    if not is_needed() or steady(given) == given:
        return None
    return {**environment, TUNABLES: steady(given), GIVEN: given}


def begin_anew() -> None:
    """Begin this process anew where its mathematics would depend on the processor; return where it does not.

    Only a process whose command line is `sys.argv` does so: one that calls a command from its own program, as tests do,
    stays what it is.
    """
    environment = steady_environment(os.environ)
    if environment is not None and sys.orig_argv[-len(sys.argv) :] == sys.argv:
        sys.stdout.flush()
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)  # noqa: S606 - this very command


def native_environment(environment: Mapping[str, str]) -> dict[str, str] | None:
    """Return what goes on top of `environment` for a child that computes as this processor does without `begin_anew`.

    None where this process does that already, or was told by its user what it does.
    """
    return {TUNABLES: environment[GIVEN]} if GIVEN in environment else None
