"""Run in robomimic's environment: read an export with its pictures, and train a tiny BC on it for two epochs.

    read_export.py FILE FOLDER

ROBOMIMIC_SOURCE names another copy of its source than the installed one. Prints what was found as one line of JSON.
"""

from __future__ import annotations

import json
import os
import sys

if os.environ.get("ROBOMIMIC_SOURCE"):
    sys.path.insert(0, os.environ["ROBOMIMIC_SOURCE"])

import h5py
import numpy as np
import robomimic
import robomimic.utils.file_utils as files
import robomimic.utils.obs_utils as observations
import torch
from robomimic.config import Config, config_factory
from robomimic.scripts.train import train
from robomimic.utils.dataset import SequenceDataset
from robomimic.utils.train_utils import load_data_for_training

_LOW_DIM = ["arm0_tool_position_in_base", "arm0_gripper"]
_PICTURE, _DEPTH = "arm0_image", "arm0_depth"
_EPOCHS, _STEPS, _ROWS = 2, 3, 4


def main(path: str, folder: str) -> None:
    """Read, train, and say what there was."""
    config = _configuration(path, folder)
    observations.initialize_obs_utils_with_config(config)
    data, _ = load_data_for_training(config, obs_keys=[*_LOW_DIM, _PICTURE, _DEPTH])
    said = _read(data, path)
    train(config, torch.device("cpu"))
    checkpoints = [name for _, _, names in os.walk(folder) for name in names if name.endswith(".pth")]
    print(json.dumps({"checkpoints": checkpoints, **said}))


def _read(data: SequenceDataset, path: str) -> dict[str, object]:
    """Compare what it gives out with what the file holds, row by row."""
    with h5py.File(path) as file:
        demo = file["data/demo_0"]
        for row in (0, 5):
            item = data[row]["obs"]
            picture = demo[f"obs/{_PICTURE}"][row : row + _ROWS]
            # What it gives out is as in the file; its models see channels first, in 0 … 1.
            np.testing.assert_array_equal(item[_PICTURE], picture)
            seen = observations.process_obs(item[_PICTURE], obs_key=_PICTURE)
            np.testing.assert_allclose(seen, np.moveaxis(picture, -1, 1) / 255.0, atol=1e-6)
            np.testing.assert_allclose(item[_LOW_DIM[0]], demo[f"obs/{_LOW_DIM[0]}"][row : row + _ROWS])
            np.testing.assert_array_equal(
                data[row]["next_obs"][_PICTURE], demo[f"next_obs/{_PICTURE}"][row : row + _ROWS]
            )
            np.testing.assert_array_equal(data[row]["holder"], demo["holder"][row : row + _ROWS])
    return {
        "version": robomimic.__version__,
        "rows": len(data),
        "environment": files.get_env_metadata_from_dataset(path)["env_name"],
    }


def _configuration(path: str, folder: str) -> Config:
    config = config_factory("bc")
    with config.values_unlocked():
        config.experiment.name = "tiny"
        config.experiment.rollout.enabled = False
        config.experiment.validate = False
        config.experiment.logging.log_tb = False
        config.experiment.epoch_every_n_steps = _STEPS
        config.experiment.save.every_n_epochs = 1
        config.train.data = path if robomimic.__version__ < "0.4" else [{"path": path}]
        config.train.output_dir = folder
        config.train.num_epochs = _EPOCHS
        config.train.batch_size = 4
        config.train.num_data_workers = 0
        config.train.seq_length = _ROWS
        config.train.dataset_keys = ("actions", "rewards", "dones", "source", "holder")
        config.train.hdf5_load_next_obs = True
        config.train.cuda = False
        config.train.hdf5_filter_key = "success"
        config.observation.modalities.obs.low_dim = _LOW_DIM
        config.observation.modalities.obs.rgb = [_PICTURE]
        config.observation.modalities.obs.depth = [_DEPTH]
        for kind in ("rgb", "depth"):
            config.observation.encoder[kind].core_kwargs = {
                "feature_dimension": 8,
                "backbone_class": "ShallowConv",
                "backbone_kwargs": {"output_channel": 32},
                "pool_class": "SpatialSoftmax",
                "pool_kwargs": {"num_kp": 4},
            }
        config.algo.actor_layer_dims = (32,)
    return config


if __name__ == "__main__":
    main(*sys.argv[1:])
