"""LeRobot's own environment, which `make test-lerobot` makes, and what is started in it."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.contract.repository import ROOT

ENVIRONMENT = ROOT / os.environ.get("LEROBOT_ENVIRONMENT", ".venv-lerobot")
_PLUGINS = Path(__file__).with_name("plugins")
_TIMEOUT_S = 240.0  # LeRobot's commands alone take 30 s to begin on a busy machine


class LeRobotPlace:
    """A folder in which LeRobot's commands run as somebody's who has a plugin of their own installed."""

    def __init__(self, folder: Path, endpoint: str = "") -> None:
        self.folder = folder
        site = folder / "site"
        for plugin in _PLUGINS.iterdir():
            shutil.copytree(plugin, site / plugin.name)
            metadata = site / f"{plugin.name}-0.dist-info" / "METADATA"
            metadata.parent.mkdir()
            metadata.write_text(f"Metadata-Version: 2.1\nName: {plugin.name}\nVersion: 0\n")
        self._environment = {
            "PATH": os.environ["PATH"],
            "HOME": str(folder),
            "PYTHONPATH": str(site),
            "XDG_STATE_HOME": os.environ["XDG_STATE_HOME"],
            "LD_LIBRARY_PATH": os.pathsep.join(map(str, _video_libraries(folder / "ffmpeg"))),
            "HF_HUB_OFFLINE": "1",
            "OMP_NUM_THREADS": "1",
            "MUJOCO_GL": os.environ.get("MUJOCO_GL", "egl"),
            **({"MART_ROUTER": endpoint} if endpoint else {}),
        }

    def run(self, *command: str | Path) -> subprocess.CompletedProcess[str]:
        """Run one of the environment's commands to its end; what it said is in `stdout`, both streams."""
        program, *arguments = command
        return subprocess.run(
            [ENVIRONMENT / "bin" / program, *arguments],
            env=self._environment,
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=_TIMEOUT_S,
            check=False,
        )

    @contextlib.contextmanager
    def started(self, command: Sequence[str]) -> Iterator[Path]:
        """Start one of the environment's commands, and end it with the block; yields the file of what it says."""
        log_path = self.folder / f"{command[0]}.log"
        with (
            log_path.open("wb") as log,
            subprocess.Popen(
                [ENVIRONMENT / "bin" / command[0], *command[1:]],
                env=self._environment,
                cwd=self.folder,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
            ) as process,
        ):
            try:
                yield log_path
            finally:
                process.terminate()
                try:
                    process.wait(30.0)
                except subprocess.TimeoutExpired:
                    process.kill()


def _video_libraries(links: Path) -> list[Path]:
    """Return where FFmpeg's libraries lie: PyAV brings them, and LeRobot looks for them by their own names."""
    links.mkdir(parents=True, exist_ok=True)
    for library in ENVIRONMENT.resolve().glob("lib/python3*/site-packages/av.libs/lib*.so.*"):
        plain = re.fullmatch(r"(lib(?:av|sw)\w+)-[0-9a-f]+(\.so\.\d+)\..*", library.name)
        if plain is not None:
            (links / "".join(plain.groups())).symlink_to(library)
    return [links, *ENVIRONMENT.resolve().glob("lib/python3*/site-packages/av.libs")]
