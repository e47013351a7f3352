"""Sizes and rates of training, as data: `debug` takes seconds, `fast` a minute or two, `paper` is as published.

Published: robomimic's tuned BC-RNN and HBC for low-dimensional human data (scripts/generate_paper_configs.py), of the
paper's own group and the nearest to what the paper leaves unsaid: batch 100, sequences of 10, LSTM 2 x 400, VAE
(1024, 1024) with latent 16, KL 5e-4 and a learned prior of 10 modes, 200,000 updates.
"""

from __future__ import annotations

from mart.protocol.errors import NotFound
from mart.trainer.models.hyperparameters import Hyperparameters

PRESETS: dict[str, Hyperparameters] = {
    "debug": Hyperparameters(
        updates=20,
        residual_updates=10,
        checkpoints=2,
        batch_size=8,
        rnn_hidden=16,
        mlp_hidden=(16,),
        vae_hidden=(16,),
        vae_latent=4,
        vae_prior_modes=3,
        residual_hidden=(16,),
        chunk_hidden=(16,),
        chunk=4,
        chunk_execute=2,
        chunk_steps=2,
        act_width=8,
        act_heads=2,
        act_layers=1,
        act_latent=4,
    ),
    "fast": Hyperparameters(
        updates=2_000,
        residual_updates=500,
        checkpoints=5,
        batch_size=64,
        learning_rate=2e-3,
        schedule="cosine",
        ema=0.99,
        rnn_hidden=128,
        mlp_hidden=(256, 256),
        vae_hidden=(256, 256),
        chunk_execute=16,  # with 8, d-MIP lifts cubes in 52 instead of 88 % of episodes: decision 0093
        chunk_hidden=(512, 512, 512),
        act_width=64,
        act_heads=4,
        act_layers=1,
    ),
    "paper": Hyperparameters(),
}


def preset(name: str) -> Hyperparameters:
    """Return the hyperparameters of a preset. Raises NotFound for an unknown name."""
    if name not in PRESETS:
        raise NotFound.named("preset", name, PRESETS)
    return PRESETS[name]
