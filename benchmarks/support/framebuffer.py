"""An X server without a screen, whose pixels are a file: what is displayed, as a process beside sees it. Needs Xvfb."""

from __future__ import annotations

import contextlib
import mmap
import shutil
import struct
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Self

import numpy as np

from mart.platform.collect.browser import chromium_path
from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.teleop_gateway.video import tick_code

_SIZE = "1400x900x24"
_LOOK_EVERY_S = 0.0005
_COLOR_BYTES = 12  # of each colour that an X window dump lists before its pixels


@contextlib.contextmanager
def screen() -> Iterator[tuple[str, Path]]:
    """Run an X server for the block; yields its display and the file that holds its pixels, an X window dump."""
    if shutil.which("Xvfb") is None:
        raise Unavailable("Xvfb is missing; install Debian's package: apt-get install xvfb.")
    with tempfile.TemporaryDirectory() as folder:
        command = ["Xvfb", "-displayfd", "1", "-screen", "0", _SIZE, "-fbdir", folder, "-nolisten", "tcp"]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ) as server:
            assert server.stdout is not None
            try:
                yield f":{server.stdout.readline().strip()}", Path(folder) / "Xvfb_screen0"
            finally:
                server.terminate()


@contextlib.contextmanager
def chromium_on(display: str) -> Iterator[Path]:
    """Yield what starts a Chromium at the left of this display, whatever it is told of being headless."""
    with tempfile.TemporaryDirectory() as folder:
        starter = Path(folder) / "chromium"
        starter.write_text(
            "#!/bin/bash\n"
            f"export DISPLAY={display}\n"
            "args=()\n"
            'for one in "$@"; do [[ $one == --headless* ]] || args+=("$one"); done\n'
            f'exec {chromium_path()} --window-position=0,0 --force-device-scale-factor=1 "${{args[@]}}"\n'
        )
        starter.chmod(0o755)
        yield starter


class PixelWatch:
    """Note when another tick's picture stands at the left of a framebuffer, on a thread of its own."""

    def __init__(self, pixels: Path) -> None:
        self._pixels = pixels
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="pixel-watch")
        self.seen: list[tuple[float, int]] = []  # Unix time in ms, tick

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        with self._pixels.open("rb") as file, mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ) as dump:
            header_size, *fields = struct.unpack(">25I", dump[:100])
            height_px, bytes_per_line, colors = fields[4], fields[11], fields[18]
            begin = header_size + _COLOR_BYTES * colors
            rows = range(begin, begin + height_px * bytes_per_line, bytes_per_line)
            row, tick = None, None
            while not self._ended.is_set():
                if row is None:  # the page is somewhere below the browser's own bars
                    row = next((one for one in rows[:: tick_code.SQUARE_PX // 2] if _tick(dump, one)), None)
                elif (now := _tick(dump, row)) is not None and now != tick:
                    tick = now
                    self.seen.append((clock.wall_ns() * 1e-6, tick))
                time.sleep(_LOOK_EVERY_S)


def _tick(dump: mmap.mmap, at: int) -> int | None:
    """Return the tick of the strip that this row of pixels is in; None where it is in none."""
    green = np.frombuffer(dump[at : at + 4 * tick_code.WIDTH_PX], np.uint8).reshape(1, -1, 4)[..., 1]
    return tick_code.read(np.broadcast_to(green, (tick_code.HEIGHT_PX, tick_code.WIDTH_PX)))
