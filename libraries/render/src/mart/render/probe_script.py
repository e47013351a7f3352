"""Load a compiled model and move it once, in a process that may be lost. Run as a script: needs nothing installed.

Arguments: the path of MuJoCo's library, the most bytes of memory and seconds of processor time. The model comes on
standard input. Ends with 0 where all went well, 1 where MuJoCo refused; anything else is a crash.
"""

from __future__ import annotations

import ctypes
import resource
import sys


def main(library: str, memory_bytes: int, processor_s: int) -> int:
    """Return the exit status."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (processor_s, processor_s))
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    mujoco = ctypes.CDLL(library)
    mjb = sys.stdin.buffer.read()
    mujoco.mj_loadModelBuffer.restype = ctypes.c_void_p
    mujoco.mj_makeData.restype = ctypes.c_void_p
    model = ctypes.c_void_p(mujoco.mj_loadModelBuffer(mjb, ctypes.c_int64(len(mjb))))
    if not model.value:
        return 1
    data = ctypes.c_void_p(mujoco.mj_makeData(model))
    if not data.value:
        return 1
    for move in (
        mujoco.mj_kinematics,
        mujoco.mj_comPos,
        mujoco.mj_camlight,
    ):  # what a renderer asks of a state
        move(model, data)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
