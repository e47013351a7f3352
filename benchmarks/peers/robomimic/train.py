"""robomimic's BC-RNN or HBC on an HDF5 file, a few updates at a time.

    train.py FILE bc|hbc

Runs in its own virtual environment (requirements.txt beside it). Reads a number of updates a line from standard input;
answers each with one line of JSON: how long they took, and what robomimic logs about them, means over them.
Sizes and rates are the tuned ones of its scripts/generate_paper_configs.py, with the mean action as head; the learning
rate is HBC's, 1e-3, for both.
"""

from __future__ import annotations

import json
import sys
import time
from unittest.mock import MagicMock

# ruff: noqa: E402  (robomimic imports what it needs for pictures whether there are pictures or not)
for name in (
    "torchvision",
    "torchvision.models",
    "torchvision.transforms",
    "torchvision.transforms.functional",
):
    sys.modules[name] = MagicMock()

import h5py
import robomimic
import robomimic.utils.file_utils as files
import robomimic.utils.obs_utils as observations
import robomimic.utils.train_utils as training
import torch
from robomimic.algo import Algo, algo_factory
from robomimic.config import Config, config_factory
from torch.utils.data import DataLoader


def main(path: str, algorithm: str) -> None:
    torch.manual_seed(0)
    config = configuration(path, algorithm)
    observations.initialize_obs_utils_with_config(config)
    shapes = files.get_shape_metadata_from_dataset(path, all_obs_keys=config.all_obs_keys, verbose=False)
    data, _ = training.load_data_for_training(config, obs_keys=shapes["all_obs_keys"])
    model = algo_factory(
        algorithm, config, shapes["all_shapes"], shapes["ac_dim"], device=torch.device("cpu")
    )
    loader = DataLoader(data, batch_size=config.train.batch_size, shuffle=True, drop_last=True)
    sizes = {"parameters": parameters(model), "windows": len(data)}
    for number, line in enumerate(sys.stdin, 1):
        begun_s = time.perf_counter()
        logged = training.run_epoch(model, loader, epoch=number, num_steps=int(line))
        took_s = time.perf_counter() - begun_s
        answer = {"version": robomimic.__version__, "took_s": took_s, "losses": logged} | sizes
        print(json.dumps(answer), flush=True)


def configuration(path: str, algorithm: str) -> Config:
    with h5py.File(path) as file:
        keys = sorted(file["data/demo_0/obs"])
    config = config_factory(algorithm)
    with config.values_unlocked():
        config.train.data = path
        config.train.batch_size = 100
        config.train.seq_length = 10
        config.train.hdf5_cache_mode = "all"
        if algorithm == "hbc":
            plan(config.algo.planner, config.observation.planner, keys)
            act(config.algo.actor, config.observation.actor, keys)
        else:
            act(config.algo, config.observation, keys)
    return config


def act(actor: Config, seen: Config, keys: list[str]) -> None:
    seen.modalities.obs.low_dim = keys
    actor.optim_params.policy.learning_rate.initial = 1e-3
    actor.actor_layer_dims = ()
    actor.rnn.enabled = True
    actor.rnn.horizon = 10
    actor.rnn.hidden_dim = 400
    actor.rnn.num_layers = 2


def plan(planner: Config, seen: Config, keys: list[str]) -> None:
    seen.modalities.obs.low_dim = keys
    seen.modalities.subgoal.low_dim = keys
    planner.optim_params.goal_network.learning_rate.initial = 1e-3
    vae = planner.vae
    vae.kl_weight = 5e-4
    vae.latent_dim = 16
    vae.encoder_layer_dims = vae.decoder_layer_dims = vae.prior_layer_dims = (1024, 1024)
    vae.prior.learn = vae.prior.is_conditioned = True
    vae.prior.use_gmm = vae.prior.gmm_learn_weights = True
    vae.prior.gmm_num_modes = 10


def parameters(model: Algo) -> int:
    parts = (model.planner, model.actor) if hasattr(model, "planner") else (model,)
    return sum(weight.numel() for part in parts for weight in part.nets.parameters())


if __name__ == "__main__":
    main(*sys.argv[1:])
