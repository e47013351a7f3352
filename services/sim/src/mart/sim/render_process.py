"""Draw an episode in a process that may be lost: a model that is spoilt, or a graphics driver, ends that one only.

`python -m mart.sim.render_process` takes the request as JSON on standard input and answers on standard output.
"""

from __future__ import annotations

import json
import signal
import sys
from pathlib import Path

from mart.protocol.errors import Corrupt, MartError, Unavailable, from_wire
from mart.runtime.child_process import STANDARD_ERROR, start_child


def render_in_process(path: Path, out: Path, viewpoint: str, width_px: int, height_px: int) -> int:
    """Do what `render_episode` does in a process of its own, and raise what it raises.

    Raises Corrupt besides where that process is lost over the episode.
    """
    request = {
        "path": str(path),
        "out": str(out),
        "viewpoint": viewpoint,
        "width_px": width_px,
        "height_px": height_px,
    }
    process = start_child([sys.executable, "-m", __name__], STANDARD_ERROR, {}, piped=True)
    try:
        answer, _ = process.communicate(json.dumps(request).encode())
    except BaseException:
        process.kill()
        process.wait()
        raise
    if process.returncode != 0 or not answer:
        raise Corrupt(
            f"{path} cannot be drawn: the process that drew it {_fate(process.returncode)}. Its model is damaged, or "
            "this machine's graphics are; `mart episodes verify` and `mart doctor` tell more."
        )
    said = json.loads(answer.splitlines()[-1])  # before it, a graphics driver may have spoken
    if "error" in said:
        raise from_wire(said["error"]["code"], said["error"]["message"])
    return int(said["frames"])


def _fate(status: int) -> str:
    return (
        f"was ended by {signal.Signals(-status).name}" if status < 0 else f"ended with exit status {status}"
    )


def _answer(request: dict[str, str | int]) -> dict[str, object]:
    try:
        from mart.sim.render_episode import render_episode
    except ImportError as error:  # of PyOpenGL, PyAV or the system's EGL
        lacks = f"Drawing needs what this installation lacks ({error}): pip install 'mart-sim[render]', and libegl1."
        return {"error": {"code": Unavailable.__name__, "message": lacks}}
    try:
        frames = render_episode(
            Path(str(request["path"])),
            Path(str(request["out"])),
            str(request["viewpoint"]),
            int(request["width_px"]),
            int(request["height_px"]),
        )
    except MartError as error:
        return {"error": {"code": error.code, "message": str(error)}}
    return {"frames": frames}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(_answer(json.load(sys.stdin))))
