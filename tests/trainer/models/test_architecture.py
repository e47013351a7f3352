"""Names of models, and points of the grid."""

from __future__ import annotations

import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.trainer.models.architecture import ModelSpec, model_names


@pytest.mark.parametrize("name", model_names())
def test_names_and_points_say_the_same_model(name: str) -> None:
    model = ModelSpec.parse(name)
    assert model.name == name
    assert ModelSpec.parse(name.upper()) == model == ModelSpec.parse(model.point)


def test_what_others_call_a_point_is_that_point() -> None:
    assert ModelSpec.parse("mimic-d") == ModelSpec.parse("d-Diffusion")
    assert ModelSpec.parse("MIMIC-D").name == "d-Diffusion"


@pytest.mark.parametrize(
    "point", ["joint/joint/none/mip", "none/joint/none/act/gmm", "joint/per-arm/joint/flow"]
)
def test_chunks_are_not_planned(point: str) -> None:
    with pytest.raises(InvalidInput):
        ModelSpec.parse(point)


def test_an_unknown_name_is_told_what_there_is() -> None:
    with pytest.raises(NotFound, match="d-MIP"):
        ModelSpec.parse("d-MAP")
