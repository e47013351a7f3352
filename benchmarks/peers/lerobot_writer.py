"""Write pictures with LeRobot's own recorder and print, as JSON, how long it took: PICTURES.npy FPS FOLDER.

Run where LeRobot is installed. PICTURES holds uint8 (cameras, frames, height, width, 3).
"""

from __future__ import annotations

import json
import sys
import time

import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset


def main(pictures_path: str, fps: str, folder: str) -> None:
    pictures = np.load(pictures_path)
    cameras, frames, height, width, _ = pictures.shape
    features = {
        f"observation.images.camera{number}": {
            "dtype": "video",
            "shape": (height, width, 3),
            "names": ["height", "width", "channels"],
        }
        for number in range(cameras)
    }
    features["action"] = {"dtype": "float32", "shape": (14,), "names": None}
    cpu_s, wall_s = time.process_time(), time.perf_counter()
    data = LeRobotDataset.create(
        "mart/peer", int(fps), features, root=folder, use_videos=True, vcodec="h264", streaming_encoding=False
    )
    for frame in range(frames):
        seen = {f"observation.images.camera{number}": pictures[number, frame] for number in range(cameras)}
        data.add_frame(seen | {"action": np.zeros(14, np.float32), "task": "Lift."})
    data.save_episode(parallel_encoding=False)
    data.finalize()
    print(json.dumps({"cpu_s": time.process_time() - cpu_s, "wall_s": time.perf_counter() - wall_s}))


if __name__ == "__main__":
    main(*sys.argv[1:])
