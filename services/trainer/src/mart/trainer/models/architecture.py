"""The family of models: one point says who plans, who acts and who corrects.

The paper's seven (section "Learning Mixed Coordination", figure "algos") are points of one grid, and every other point
works too:

    planner {none, joint, per-arm}  x  actor {joint, per-arm}  x  residual {none, joint, per-arm}

"joint" is one network that sees the observations of all arms; "per-arm" is one network for each arm that sees only
what that arm's operator sees.
"""

from __future__ import annotations

import re
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, model_validator

from mart.protocol.errors import InvalidInput, NotFound

Span = Literal["none", "joint", "per-arm"]
Network = Literal["rnn", "mlp", "flow", "mip", "diffusion", "act"]
Head = Literal["l2", "gmm"]
_CHUNKED: frozenset[Network] = frozenset({"flow", "mip", "diffusion", "act"})


class ModelSpec(BaseModel):
    """One model of the family: a point of the grid.

    network: what the actor is; `rnn` an LSTM over ten steps, `mlp` without memory. Chunks of actions at once: `flow` by
    flow matching, `mip` by regression in two steps, `diffusion` by diffusion, `act` by a transformer.
    head: what an rnn or mlp ends in; `l2` the mean action (the paper's objective), `gmm` a mixture of Gaussians.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    planner: Span
    actor: Literal["joint", "per-arm"]
    residual: Span = "none"
    network: Network = "rnn"
    head: Head = "l2"

    @model_validator(mode="after")
    def _chunks_have_no_planner(self) -> Self:
        if self.is_chunked and (self.planner, self.head) != ("none", "l2"):
            raise ValueError("a model of chunks has neither planner nor another head")
        return self

    @property
    def is_chunked(self) -> bool:
        """Whether it says several ticks' actions at once."""
        return self.network in _CHUNKED

    @property
    def name(self) -> str:
        """The paper's name where it has one, else the point itself; `parse` reads either."""
        return _NAMES.get(self) or self.point

    @property
    def point(self) -> str:
        """The point, like `joint/per-arm/none`, followed by `/mlp`, `/gmm` or both where they are not the usual."""
        extra = (self.network, "rnn"), (self.head, "l2")
        parts = [self.planner, self.actor, self.residual, *(word for word, usual in extra if word != usual)]
        return "/".join(parts)

    @classmethod
    def parse(cls, text: str) -> ModelSpec:
        """Return the model of a name in any case, or of a point.

        Raises NotFound, naming what there is, and InvalidInput.
        """
        named = {name.lower(): model for name, model in (PAPER | BASELINES | _ALSO_KNOWN_AS).items()}
        if text.lower() in named:
            return named[text.lower()]
        match = _POINT.fullmatch(text.lower())
        if match is None:
            raise NotFound.named("model", text, (*_NAMES.values(), "PLANNER/ACTOR/RESIDUAL"))
        given = {key: value for key, value in match.groupdict().items() if value}
        try:
            return cls.model_validate(given)
        except ValueError as error:
            raise InvalidInput(
                f"The model {text!r} was given, but a model of chunks has neither planner nor another head; "
                f"use none/{match['actor']}/{match['residual']}/{match['network']}."
            ) from error


_POINT = re.compile(
    r"(?P<planner>none|joint|per-arm)/(?P<actor>joint|per-arm)/(?P<residual>none|joint|per-arm)"
    r"(?:/(?P<network>rnn|mlp|flow|mip|diffusion|act))?(?:/(?P<head>l2|gmm))?"
)

# The paper's seven first, in the order of its table, then the baselines beside them.
PAPER: dict[str, ModelSpec] = {
    "BC-RNN": ModelSpec(planner="none", actor="joint"),
    "HBC": ModelSpec(planner="joint", actor="joint"),
    "d-HBC": ModelSpec(planner="per-arm", actor="per-arm"),
    "dh-HBC": ModelSpec(planner="per-arm", actor="joint"),
    "dl-HBC": ModelSpec(planner="joint", actor="per-arm"),
    "r-HBC": ModelSpec(planner="per-arm", actor="per-arm", residual="joint"),
    "rd-HBC": ModelSpec(planner="joint", actor="joint", residual="per-arm"),
}
BASELINES: dict[str, ModelSpec] = {
    "BC": ModelSpec(planner="none", actor="joint", network="mlp"),
    "d-BC": ModelSpec(planner="none", actor="per-arm", network="mlp"),
    "d-BC-RNN": ModelSpec(planner="none", actor="per-arm"),
    "BC-RNN-GMM": ModelSpec(planner="none", actor="joint", head="gmm"),
    "d-BC-RNN-GMM": ModelSpec(planner="none", actor="per-arm", head="gmm"),
    "Flow": ModelSpec(planner="none", actor="joint", network="flow"),
    "d-Flow": ModelSpec(planner="none", actor="per-arm", network="flow"),
    "r-Flow": ModelSpec(planner="none", actor="per-arm", residual="joint", network="flow"),
    "rd-Flow": ModelSpec(planner="none", actor="joint", residual="per-arm", network="flow"),
    "MIP": ModelSpec(planner="none", actor="joint", network="mip"),
    "d-MIP": ModelSpec(planner="none", actor="per-arm", network="mip"),
    "Diffusion": ModelSpec(planner="none", actor="joint", network="diffusion"),
    "d-Diffusion": ModelSpec(planner="none", actor="per-arm", network="diffusion"),
    "ACT": ModelSpec(planner="none", actor="joint", network="act"),
    "d-ACT": ModelSpec(planner="none", actor="per-arm", network="act"),
}
# What others call the same point; why it is the same: layers/diffusion.py.
_ALSO_KNOWN_AS: dict[str, ModelSpec] = {"MIMIC-D": BASELINES["d-Diffusion"]}
_NAMES: dict[ModelSpec, str] = {model: name for name, model in (PAPER | BASELINES).items()}


def model_names() -> tuple[str, ...]:
    """Return the names of the models that have one, the paper's seven first."""
    return tuple(_NAMES.values())
