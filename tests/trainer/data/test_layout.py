"""Columns by name, arms' parts, and the one sign of a rotation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task, task_names
from mart.trainer.data.layout import ObservationLayout, canonical

_numbers = st.floats(-1, 1)


@pytest.mark.parametrize("name", task_names())
def test_every_task_is_covered_by_its_arms_parts(name: str) -> None:
    layout = ObservationLayout.of(get_task(name))
    parts = [layout.columns_of(arm) for arm in layout.arms]
    assert sorted(set(np.concatenate(parts))) == list(range(layout.width))
    for arm, part in zip(layout.arms, parts, strict=True):
        own = [o for o in get_task(name).observations if arm in o.arms]
        assert len(part) == sum(int(np.prod(o.shape)) for o in own)


@given(st.lists(_numbers, min_size=4, max_size=4))
def test_a_rotation_has_one_sign(q: list[float]) -> None:
    both = canonical(np.array([q, [-x for x in q]]))
    if max(map(abs, q)) > 1e-3:
        np.testing.assert_array_equal(both[0], both[1])


def test_the_vector_is_the_catalogues_order() -> None:
    layout = ObservationLayout.of_arms("two_arm_multi_cube_lifting", 2)
    seen = {s.name: np.full((3, *s.shape), float(i)) for i, s in enumerate(layout.fields)}
    np.testing.assert_array_equal(layout.vector(seen)[1], layout.groups())


def test_what_is_missing_misshapen_or_no_number_is_named() -> None:
    layout = ObservationLayout.of_arms("two_arm_multi_cube_lifting", 2)
    good = {s.name: np.zeros((2, *s.shape)) for s in layout.fields}
    with pytest.raises(InvalidInput):
        layout.vector({name: value for name, value in good.items() if name != "arm0/gripper"})
    with pytest.raises(InvalidInput):
        layout.vector(good | {"arm0/gripper": np.zeros((2, 3))})
    with pytest.raises(InvalidInput):
        layout.vector(good | {"arm1/gripper": np.array([[0.0], [np.nan]])})
    with pytest.raises(NotFound):
        layout.columns_of("arm7")
