"""Print what is in a data set, as JSON, read by LeRobot's own loader: FOLDER. Run where LeRobot is installed."""

from __future__ import annotations

import json
import sys

import av
from lerobot.datasets.lerobot_dataset import LeRobotDataset

_CAMERA = "observation.images.arm0"


def main(folder: str) -> None:
    """Load everything. Pictures are decoded by PyAV: LeRobot 0.4's decoder wants FFmpeg's libraries on the machine."""
    data = LeRobotDataset("mart/seat", root=folder)
    first, last = data.hf_dataset[0], data.hf_dataset[len(data) - 1]
    pictures = []
    for episode in range(data.num_episodes):
        with av.open(str(data.root / data.meta.get_video_file_path(episode, _CAMERA))) as video:
            pictures += [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    print(
        json.dumps(
            {
                "episodes": data.num_episodes,
                "frames": len(data),
                "fps": data.fps,
                "robot": data.meta.robot_type,
                "names": data.features["observation.state"]["names"],
                "action": last["action"].tolist(),
                "heights_m": [item["observation.state"][2].item() for item in (first, last)],
                "picture": list(pictures[0].shape),
                "brightness": float(pictures[0].mean()) / 255.0,
                "tasks": list(data.meta.tasks.index),
            }
        )
    )


if __name__ == "__main__":
    main(sys.argv[1])
