"""Sizes and rates of models and their training: everything that decides a run but its data, model and seeds."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Hiding = Literal["swap", "drop", "blur"]


class Hyperparameters(BaseModel):
    """Everything that decides a training but the data, the model and the seed."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # Updates
    updates: int = Field(200_000, ge=1)
    residual_updates: int = Field(20_000, ge=1)  # after the base's, which is frozen then
    checkpoints: int = Field(20, ge=1)  # evenly spaced over all updates
    batch_size: int = Field(100, ge=1)
    learning_rate: float = Field(1e-3, gt=0)  # of Adam
    schedule: Literal["constant", "cosine"] = "constant"
    precision: Literal["auto", "float32", "bfloat16"] = (
        "auto"  # of matrix products; auto: what is faster here
    )
    weight_decay: float = Field(0.0, ge=0)  # of AdamW; 0: Adam
    ema: float | None = Field(None, gt=0, lt=1)  # decay of the average of weights that acts, if any

    # Observations
    normalise: bool = True  # to mean 0 and deviation 1 over the data; robomimic's published runs do not
    observation_noise: float = Field(0.0, ge=0)  # while learning, in deviations; the same for a whole window

    # One arm alone: how a joint planner and actor learn not to rely on what other arms happen to do (one_arm.py)
    one_arm_share: float = Field(0.0, ge=0, le=1)  # of the windows
    one_arm_hides: Hiding = "swap"  # what is done to all that the arm does not see

    # Sequences: the subgoal is what is seen `window` ticks ahead, and the LSTM begins anew as often
    window: int = Field(10, ge=1)

    # Actor
    rnn_hidden: int = Field(400, ge=1)
    rnn_layers: int = Field(2, ge=1)
    mlp_hidden: tuple[int, ...] = (1024, 1024)  # of an actor without memory
    gmm_modes: int = Field(5, ge=1)

    # Planner
    vae_hidden: tuple[int, ...] = (1024, 1024)
    vae_latent: int = Field(16, ge=1)
    vae_prior_modes: int = Field(10, ge=1)
    kl_weight: float = Field(5e-4, ge=0)

    # Residual
    residual_hidden: tuple[int, ...] = (256, 256)
    residual_epsilon: float = Field(0.05, ge=0)  # bound of an arm's correction, in units of its action
    residual_subgoal: Literal["posterior", "prior", "true"] = "posterior"  # its base's, while it learns

    # Flow
    flow_hidden: tuple[int, ...] = (512, 512, 512)
    flow_chunk: int = Field(16, ge=1)  # actions that are predicted at once
    flow_execute: int = Field(8, ge=1)  # how many of them are done before the next chunk
    flow_steps: int = Field(10, ge=1)  # of Euler's method
