"""Print what is in a data set, as JSON, read by LeRobot's own loader: FOLDER. Run where LeRobot is installed."""

from __future__ import annotations

import json
import sys

from lerobot.datasets.lerobot_dataset import LeRobotDataset


def main(folder: str) -> None:
    """Load everything, the pictures too."""
    data = LeRobotDataset("mart/seat", root=folder)
    first, last = data[0], data[len(data) - 1]
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
                "picture": list(first["observation.images.arm0"].shape),
                "brightness": first["observation.images.arm0"].mean().item(),
                "task": first["task"],
            }
        )
    )


if __name__ == "__main__":
    main(sys.argv[1])
