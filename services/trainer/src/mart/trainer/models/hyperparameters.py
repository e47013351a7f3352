"""Sizes and rates of models and their training: everything that decides a run but its data, model and seeds."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

_RENAMED = {
    "flow_hidden": "chunk_hidden",
    "flow_chunk": "chunk",
    "flow_execute": "chunk_execute",
    "flow_steps": "chunk_steps",
}

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

    # Chunks: of flow, mip and diffusion, which are perceptrons, and of act
    chunk: int = Field(16, ge=1)  # actions that are predicted at once
    chunk_execute: int = Field(8, ge=1)  # how many of them are done before the next chunk
    normalise_actions: bool = False  # to mean 0 and deviation 1; decision 0093: worse
    action_target: Literal["delta", "absolute"] = (
        "delta"  # steps as recorded, or poses from where a chunk begins
    )
    chunk_ensemble: float | None = Field(
        None, ge=0
    )  # a chunk every tick, averaged, each weighing exp(-this) of the one before
    chunk_hidden: tuple[int, ...] = (512, 512, 512)
    chunk_steps: int = Field(10, ge=1)  # of Euler's method: flow and diffusion
    act_width: int = Field(256, ge=1)
    act_heads: int = Field(8, ge=1)
    act_layers: int = Field(4, ge=1)  # of each of its three transformers
    act_latent: int = Field(32, ge=1)
    act_kl_weight: float = Field(10.0, ge=0)

    @model_validator(mode="before")
    @classmethod
    def _renamed(cls, given: Any) -> Any:
        """Read the names that checkpoints and runs of 0.1.0 have."""
        return {_RENAMED.get(name, name): value for name, value in dict(given).items()}

    @model_validator(mode="after")
    def _heads_part_the_width(self) -> Hyperparameters:
        if self.act_width % self.act_heads:
            raise ValueError(f"act_width {self.act_width} must be a multiple of act_heads {self.act_heads}")
        return self

    @property
    def executed(self) -> int:
        """How many actions of a chunk are done."""
        return min(self.chunk, self.chunk_execute)
