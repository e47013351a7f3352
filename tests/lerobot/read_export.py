"""Print what LeRobot makes of an export, as JSON: FOLDER OTHER_FOLDER WORK. Run where LeRobot is installed.

OTHER_FOLDER is an export of other episodes that fits the first one; WORK takes what LeRobot's tools make of them.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from lerobot.datasets.dataset_tools import delete_episodes, merge_datasets, split_dataset
from lerobot.datasets.lerobot_dataset import LeRobotDataset

_CAMERA = "observation.images.arm0"


def main(folder: str, other_folder: str, work: str) -> None:
    """Load all, then delete, split and merge, and say how each is normalised."""
    data, other = (LeRobotDataset("mart/export", root=path) for path in (folder, other_folder))
    items = [data[number] for number in range(len(data))]
    np.save(Path(work) / "pictures.npy", np.array([item[_CAMERA].numpy() for item in items]))
    left = delete_episodes(data, [0], output_dir=Path(work) / "left", repo_id="mart/left")
    halves = split_dataset(data, {"first": [0], "second": [1]}, output_dir=Path(work) / "split")
    merged = merge_datasets([data, other], output_repo_id="mart/all", output_dir=Path(work) / "merged")
    print(
        json.dumps(
            {
                "frames": len(data),
                "episodes": data.num_episodes,
                "shape": [*items[0][_CAMERA].shape],
                "task": items[0]["task"],
                "data": _normalised(data),
                "left": _normalised(left),
                "second": _normalised(halves["second"]),
                "merged": _normalised(merged),
            }
        )
    )


def _normalised(data: LeRobotDataset) -> dict[str, Any]:
    stats = data.meta.stats
    return {
        "episodes": data.num_episodes,
        "picture": np.asarray(stats[_CAMERA]["mean"]).tolist(),
        "action": np.asarray(stats["action"]["std"]).tolist(),
        "first": float(data[0][_CAMERA].mean()),
    }


if __name__ == "__main__":
    main(*sys.argv[1:])
