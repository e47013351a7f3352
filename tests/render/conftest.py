"""A world small enough to be written here: a red ball above a green one that can be moved."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

TWO_BALLS = """
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="front" pos="0 -2 0" euler="90 0 0"/>
    <camera name="above" pos="0 0 3"/>
    <geom type="sphere" size="0.2" pos="0.3 0 0.4" rgba="1 0 0 1"/>
    <body name="ball" pos="0.3 0 -0.4">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom type="sphere" size="0.2" rgba="0 1 0 1"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(TWO_BALLS)


def state_of(model: mujoco.MjModel, slide_m: float = 0.0) -> bytes:
    """The integration state with the green ball moved along x."""
    data = mujoco.MjData(model)
    data.qpos[0] = slide_m
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    return state.tobytes()
