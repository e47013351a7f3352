"""Say what the numbers of this process's worlds depend on besides their model: processor, C library, MuJoCo.

The fingerprint is a digest of fixed computations by what worlds are stepped with: the C library's functions, and a
small world of MuJoCo's with joints and contacts. Processes of one fingerprint step worlds to the same bits, as far as
is known.
"""

from __future__ import annotations

import functools
import hashlib
import math
import os
import struct
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np

from mart.protocol.messages import Numerics
from mart.runtime.steady_libm import TUNABLES

_POINTS = 256
_STEPS = 200
_FLAGS = ("avx", "avx2", "fma", "fma4", "avx512f")  # what the libraries choose their variants by
_DIGEST_BYTES = 8
_CPUINFO = Path("/proc/cpuinfo")

_ONE_ARGUMENT: tuple[tuple[Callable[[float], float], float, float], ...] = (
    (math.sin, -20.0, 20.0),
    (math.cos, -20.0, 20.0),
    (math.tan, -1.5, 1.5),
    (math.asin, -1.0, 1.0),
    (math.acos, -1.0, 1.0),
    (math.atan, -9.0, 9.0),
    (math.exp, -30.0, 30.0),
    (math.log, 1e-6, 50.0),
    (math.tanh, -3.0, 3.0),
)
_TWO_ARGUMENTS: tuple[Callable[[float, float], float], ...] = (math.atan2, math.pow, math.hypot)

# A chain of hinges that falls onto a plane, a box and a ball: kinematics, constraints, contacts and their solver.
_WORLD = """
<mujoco>
  <option timestep="0.002" cone="elliptic" integrator="implicitfast"/>
  <worldbody>
    <geom type="plane" size="2 2 0.1"/>
    <body pos="0 0 0.5">
      <joint type="hinge" axis="0 1 0.3" damping="0.1"/>
      <geom type="capsule" size="0.03" fromto="0 0 0 0.3 0 0"/>
      <body pos="0.3 0 0">
        <joint type="hinge" axis="0.2 1 0" range="-1.2 1.2" limited="true"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0.3 0.1 0"/>
      </body>
    </body>
    <body pos="0.35 0.05 0.06" euler="20 30 5"><freejoint/><geom type="box" size="0.05 0.04 0.03"/></body>
    <body pos="0.1 0.0 0.2"><freejoint/><geom type="sphere" size="0.04"/></body>
  </worldbody>
</mujoco>
"""


@functools.cache
def own_numerics() -> Numerics:
    """Return what this process computes with; found out once, in about 20 ms."""
    return Numerics(
        processor=_processor(),
        libm=_libm(),
        mujoco_build=f"{mujoco.__version__} {_library_digest()}",
        fingerprint=_fingerprint(),
    )


def _fingerprint() -> str:
    digest = hashlib.blake2b(digest_size=_DIGEST_BYTES)
    for function, low, high in _ONE_ARGUMENT:
        digest.update(_packed(map(function, np.linspace(low, high, _POINTS).tolist())))
    arguments = np.linspace(0.01, 4.0, _POINTS).tolist()
    for of_two in _TWO_ARGUMENTS:
        digest.update(_packed(map(of_two, arguments, reversed(arguments))))
    model = mujoco.MjModel.from_xml_string(_WORLD)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, _STEPS)
    for values in (data.qpos, data.qvel, data.qacc):
        digest.update(np.asarray(values, "<f8").tobytes())
    return digest.hexdigest()


def _packed(values: map[float]) -> bytes:
    return struct.pack(f"<{_POINTS}d", *values)


def _processor() -> str:
    """Return the machine, those of its flags that matter, and what is switched off for this process."""
    lines = _CPUINFO.read_text(errors="replace").splitlines() if _CPUINFO.exists() else []
    said = next((line.partition(":")[2].split() for line in lines if line.startswith("flags")), [])
    flags = " ".join(flag for flag in _FLAGS if flag in said)
    tunables = os.environ.get(TUNABLES, "")
    return " ".join(filter(None, (os.uname().machine, flags, tunables and f"({tunables})")))


def _libm() -> str:
    names = os.confstr_names
    return (os.confstr("CS_GNU_LIBC_VERSION") if "CS_GNU_LIBC_VERSION" in names else None) or "unknown"


def _library_digest() -> str:
    """Return a digest of MuJoCo's library: builds of one version may differ."""
    digest = hashlib.blake2b(digest_size=_DIGEST_BYTES)
    for library in sorted(Path(mujoco.__file__).parent.glob("libmujoco*")):
        digest.update(library.read_bytes())
    return digest.hexdigest()
