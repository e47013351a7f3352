"""Find out in a process that may be lost whether MuJoCo can load a model: its loader crashes or hangs over some.

A model comes from a file or over the bus, and its digest stands beside it, so the digest vouches for nothing. What was
found is remembered by the digest, so that each model is tried once.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import threading
from collections import OrderedDict
from pathlib import Path

import mujoco

from mart.render import probe_script

_MEMORY_BYTES = 4 * 1024**3
_PROCESSOR_S = 10  # 0.1 s is usual
_DEADLINE_S = 60.0  # of a busy machine
_REMEMBERED = 64

_found: OrderedDict[str, str] = OrderedDict()  # digest → what was found
_lock = threading.Lock()


def objection_to(mjb: bytes, sha256: str) -> str:
    """Return what MuJoCo does over this model instead of loading it, in words; nothing where it loads.

    sha256: the digest of `mjb`, which must have been found right.
    """
    with _lock:
        if sha256 not in _found:
            _found[sha256] = _probe(mjb)
        _found.move_to_end(sha256)
        while len(_found) > _REMEMBERED:
            _found.popitem(last=False)
        return _found[sha256]


def _probe(mjb: bytes) -> str:
    command = [sys.executable, "-I", "-S", probe_script.__file__, str(_library())]
    with tempfile.TemporaryDirectory() as folder:  # MuJoCo writes MUJOCO_LOG.TXT to wherever it runs
        try:
            done = subprocess.run(  # noqa: S603 - our own script
                [*command, str(_MEMORY_BYTES), str(_PROCESSOR_S)],
                input=mjb,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=folder,
                timeout=_DEADLINE_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return f"is at it for more than {_DEADLINE_S:g} s"
    if done.returncode == 0:
        return ""
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"is at it for more than {_PROCESSOR_S} s"
    if done.returncode < 0:
        return f"crashes over it ({signal.Signals(-done.returncode).name})"
    return "refuses it"


def _library() -> Path:
    """Return MuJoCo's own shared library, as its package brings it."""
    (library,) = Path(mujoco.__file__).parent.glob(f"libmujoco*{mujoco.__version__}*")
    return library
