"""Draw an episode in a process that may be lost: a model that is spoilt, or a graphics driver, ends that one only.

`python -m mart.sim.render_process` takes the request as JSON on standard input and answers on standard output: a line
for each picture, then one of JSON.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, MartError, Unavailable, from_wire
from mart.protocol.recording import EpisodeRecord
from mart.runtime.child_process import STANDARD_ERROR, start_child

_PICTURE = b"picture\n"


def picture_count(path: Path) -> int:
    """Return how many pictures a video of the whole episode has, as its file says; 0 where it does not say."""
    file = EpisodeFile.open(path)
    return file.episode.ticks + 1 if EpisodeRecord.NAME in file.metadata else 0


def render_in_process(
    path: Path,
    out: Path,
    viewpoint: str,
    width_px: int,
    height_px: int,
    *,
    on_picture: Callable[[], None] = lambda: None,
) -> int:
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
        answer = _asked(process, json.dumps(request).encode(), on_picture)
    except BaseException:
        process.kill()
        raise
    finally:
        process.wait()
    if process.returncode != 0 or not answer:
        raise Corrupt(
            f"{path} cannot be drawn: the process that drew it {_fate(process.returncode)}. Its model is damaged, or "
            "this machine's graphics are; `mart episodes verify` and `mart doctor` tell more."
        )
    said: dict[str, Any] = json.loads(answer)
    if "error" in said:
        raise from_wire(said["error"]["code"], said["error"]["message"])
    return int(said["frames"])


def _asked(process: subprocess.Popen[bytes], request: bytes, on_picture: Callable[[], None]) -> bytes:
    """Return the last line that the process says, and count its pictures; drivers may say something between."""
    assert process.stdin is not None
    assert process.stdout is not None
    with process.stdin as stdin, process.stdout as stdout:
        try:
            stdin.write(request)
            stdin.close()
        except BrokenPipeError:  # it is lost already; its exit status says how
            return b""
        last = b""
        for line in stdout:
            last = line
            if line == _PICTURE:
                on_picture()
        return last


def _fate(status: int) -> str:
    return (
        f"was ended by {signal.Signals(-status).name}" if status < 0 else f"ended with exit status {status}"
    )


def _answer(request: dict[str, Any]) -> dict[str, object]:
    try:
        from mart.sim.render_episode import render_episode
    except ImportError as error:  # of PyOpenGL, PyAV or the system's EGL
        lacks = f"Drawing needs what this installation lacks ({error}): pip install 'mart-sim[render]', and libegl1."
        return {"error": {"code": Unavailable.__name__, "message": lacks}}

    def on_picture() -> None:
        sys.stdout.buffer.write(_PICTURE)
        sys.stdout.buffer.flush()

    try:
        frames = render_episode(
            Path(request["path"]),
            Path(request["out"]),
            request["viewpoint"],
            request["width_px"],
            request["height_px"],
            on_picture=on_picture,
        )
    except MartError as error:
        return {"error": {"code": error.code, "message": str(error)}}
    return {"frames": frames}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(_answer(json.load(sys.stdin))))
