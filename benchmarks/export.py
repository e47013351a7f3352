"""An export with pictures: samples a second, and beside LeRobot's own recorder on the very same pictures.

Ours draws them besides; what is compared is what both do with them, to H.264 in MP4. And a live minute of two emulated
people, whose recorded pictures show the ticks that the log has at their times. Needs LeRobot's environment, which `make
test-lerobot` makes (LEROBOT_ENVIRONMENT names another).

    python benchmarks/export.py
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from report import Bar, report
from support.recorded_ticks import ticks_apart

from mart.episodes.reader import open_episode
from mart.recorder.export.cameras import CameraRequest
from mart.recorder.export.pictures import EpisodePictures
from mart.recorder.export.videos import write_video

LEROBOT = Path(os.environ.get("LEROBOT_ENVIRONMENT", ".venv-lerobot"))
PEER = Path(__file__).parent / "peers" / "lerobot_writer.py"
CAMERAS = (CameraRequest("arm0", 224, 224), CameraRequest("front", 224, 224))
CONTROL_HZ = 20
EPISODES = 4
TASK = "two_arm_multi_cube_lifting"
LARGEST_SHARE = 1.0
TASKS = Path(__file__).parent.parent / "examples" / "tasks"
MINUTE_S = 62  # a little more, since the first picture may come late
MOST_TICKS_APART = 1


def main() -> None:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        _mart("collect", "--task", TASK, "--episodes", f"{EPISODES}", "--operators", "script,script", "--lockstep",
              "--out", f"{folder}/data")  # fmt: skip
        episodes = folder / "data" / "episodes"
        rates = {
            f"jobs_{jobs}_samples_per_s": _exported(episodes, folder / f"jobs-{jobs}", jobs)
            for jobs in (1, 2)
        }
        pictures = _drawn(min(episodes.rglob("*.mcap")))
        ours = _encoded(pictures, folder)
        np.save(folder / "pictures.npy", pictures)
        theirs = _lerobots(folder)
        apart = _ticks_apart(folder)
        report(
            "export",
            {
                **rates,
                "encode_cpu_s": ours,
                "frames": pictures.shape[1],
                "cameras": len(CAMERAS),
                "live_pictures": len(apart),
                "live_pictures_a_tick_apart": int((apart == 1).sum()),
            },
            {"encode_cpu_s": theirs["cpu_s"], "encode_wall_s": theirs["wall_s"]},
            [
                Bar.at_most("encode_over_lerobot_cpu", ours / theirs["cpu_s"], LARGEST_SHARE),
                Bar.at_most("ticks_apart_over_a_minute", float(apart.max()), MOST_TICKS_APART),
            ],
        )


def _mart(*arguments: str) -> dict[str, Any]:
    done = subprocess.run(
        [Path(sys.executable).with_name("mart"), *arguments, "--json"],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def _exported(episodes: Path, out: Path, jobs: int) -> float:
    """Return how many ticks a second, each with its pictures, a whole command writes."""
    cameras = [word for camera in CAMERAS for word in ("--camera", str(camera))]
    options = ["--format", "lerobot", "--out", str(out), "--jobs", f"{jobs}", *cameras]
    before_s = time.perf_counter()
    ticks: int = _mart("episodes", "export", str(episodes), *options)["ticks"]
    return ticks / (time.perf_counter() - before_s)


def _drawn(path: Path) -> NDArray[np.uint8]:
    file = open_episode(path)
    data, pictures = file.arrays(), EpisodePictures(file, ())
    return np.array([[*pictures.of(data, camera)] for camera in CAMERAS])


def _encoded(pictures: NDArray[np.uint8], folder: Path) -> float:
    def each(of_camera: NDArray[np.uint8]) -> Iterator[NDArray[np.uint8]]:
        yield from of_camera

    before_s = time.process_time()
    for camera, of_camera in zip(CAMERAS, pictures, strict=True):
        write_video(folder / f"{camera.key}.mp4", each(of_camera), camera, CONTROL_HZ)
    return time.process_time() - before_s


def _ticks_apart(folder: Path) -> NDArray[np.int64]:
    """Record a minute of a task that is never done, and compare what both people saw with its log."""
    shutil.copytree(TASKS, folder / "tasks")
    task = folder / "tasks" / "two_arm_drawer.toml"
    wanted = task.read_text().replace("at_most = 0.02", "at_most = -1.0")
    task.write_text(wanted.replace("trial_limit_s = 30", f"trial_limit_s = {MINUTE_S}"))
    _mart("collect", "--task", f"{task}", "--time-limit", f"{MINUTE_S}", "--out", f"{folder}/live")
    (episode,) = (folder / "live").rglob("*.mcap")
    return np.concatenate([ticks_apart(episode, arm) for arm in open_episode(episode).episode.arms])


def _lerobots(folder: Path) -> dict[str, float]:
    paths = LEROBOT / "bin" / "python", PEER, folder / "pictures.npy", folder / "peer"
    python, script, pictures, out = map(str, paths)
    command = [python, script, pictures, f"{CONTROL_HZ}", out]
    environment = os.environ | {"HF_HUB_OFFLINE": "1", "OMP_NUM_THREADS": "1", "HOME": str(folder)}
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


if __name__ == "__main__":
    main()
