"""robomimic's BC-RNN or HBC for the episodes of an HDF5 file.

What is published stands in its scripts/generate_paper_configs.py, with the mean action as head; the learning rate is
HBC's, 1e-3, for both.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
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
import robomimic.utils.file_utils as files
import robomimic.utils.obs_utils as observations
import robomimic.utils.train_utils as training
import torch
from robomimic.algo import Algo, algo_factory
from robomimic.config import Config, config_factory
from torch.utils.data import DataLoader, Dataset


@dataclass(frozen=True)
class Sizes:
    """The published ones."""

    batch: int = 100
    lstm: int = 400
    vae: Sequence[int] = (1024, 1024)


@dataclass(frozen=True)
class Learner:
    model: Algo
    loader: DataLoader
    data: Dataset


def learner(path: str, algorithm: str, sizes: Sizes, filter_key: str | None = None) -> Learner:
    """`algorithm`: bc or hbc. `filter_key`: only these episodes of the file."""
    config = _configuration(path, algorithm, sizes)
    observations.initialize_obs_utils_with_config(config)
    shapes = files.get_shape_metadata_from_dataset(path, all_obs_keys=config.all_obs_keys, verbose=False)
    with config.values_unlocked():
        config.train.hdf5_filter_key = filter_key
    data, _ = training.load_data_for_training(config, obs_keys=shapes["all_obs_keys"])
    model = algo_factory(
        algorithm, config, shapes["all_shapes"], shapes["ac_dim"], device=torch.device("cpu")
    )
    loader = DataLoader(data, batch_size=config.train.batch_size, shuffle=True, drop_last=True)
    return Learner(model, loader, data)


def parameters(model: Algo) -> int:
    parts = (model.planner, model.actor) if hasattr(model, "planner") else (model,)
    return sum(weight.numel() for part in parts for weight in part.nets.parameters())


def _configuration(path: str, algorithm: str, sizes: Sizes) -> Config:
    with h5py.File(path) as file:
        keys = sorted(file["data/demo_0/obs"])
    config = config_factory(algorithm)
    with config.values_unlocked():
        config.train.data = path
        config.train.batch_size = sizes.batch
        config.train.seq_length = 10
        config.train.hdf5_cache_mode = "all"
        if algorithm == "hbc":
            _plan(config.algo.planner, config.observation.planner, keys, sizes)
            _act(config.algo.actor, config.observation.actor, keys, sizes)
        else:
            _act(config.algo, config.observation, keys, sizes)
    return config


def _act(actor: Config, seen: Config, keys: list[str], sizes: Sizes) -> None:
    seen.modalities.obs.low_dim = keys
    actor.optim_params.policy.learning_rate.initial = 1e-3
    actor.actor_layer_dims = ()
    actor.rnn.enabled = True
    actor.rnn.horizon = 10
    actor.rnn.hidden_dim = sizes.lstm
    actor.rnn.num_layers = 2


def _plan(planner: Config, seen: Config, keys: list[str], sizes: Sizes) -> None:
    seen.modalities.obs.low_dim = keys
    seen.modalities.subgoal.low_dim = keys
    planner.optim_params.goal_network.learning_rate.initial = 1e-3
    vae = planner.vae
    vae.kl_weight = 5e-4
    vae.latent_dim = 16
    vae.encoder_layer_dims = vae.decoder_layer_dims = vae.prior_layer_dims = tuple(sizes.vae)
    vae.prior.learn = vae.prior.is_conditioned = True
    vae.prior.use_gmm = vae.prior.gmm_learn_weights = True
    vae.prior.gmm_num_modes = 10
