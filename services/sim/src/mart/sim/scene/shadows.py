"""Lay soft spots under the tools and the things: they show height, which a single picture hides.

Real shadows would double the time of a software-rendered frame. The spots are mocap bodies, so they travel with the
state and look the same to everybody who renders it; nothing collides with them.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.sim.scene.data import Data
from mart.sim.scene.palette import rgba

_PIXELS = 64
_DARKNESS = 0.62
_ALPHA = 0.9
_Z_M = 0.0008


class Shadows:
    """Keep each spot under its caster, in one world or in every one of a batch."""

    def __init__(self, model: mujoco.MjModel, data: Data) -> None:
        spots = [i for i in range(model.nbody) if model.body(i).name.endswith("/shadow")]
        casters = {model.body(i).name.removesuffix("/shadow"): int(model.body_mocapid[i]) for i in spots}
        sites = {name: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"{name}/tool") for name in casters}
        tools = [name for name in casters if sites[name] >= 0]
        things = [name for name in casters if sites[name] < 0]
        places = {name: data.site_xpos[..., sites[name], :2] for name in tools} | {
            name: data.body(name).xpos[..., :2] for name in things
        }
        self._follow = [(data.mocap_pos[..., casters[name], :2], place) for name, place in places.items()]

    def follow(self) -> None:
        """Move every spot to its caster."""
        for spot, place in self._follow:
            np.copyto(spot, place)


def add_shadow_material(spec: mujoco.MjSpec) -> None:
    """Add the spots' texture and material."""
    image = _spot()
    texture = spec.add_texture(
        name="shadow", type=mujoco.mjtTexture.mjTEXTURE_2D, width=_PIXELS, height=_PIXELS, nchannel=4
    )
    texture.data = image.tobytes()
    # An alpha below 1 sends the geom through the blended pass, where the texture's own alpha counts.
    material = spec.add_material(name="shadow", rgba=(0, 0, 0, _ALPHA), specular=0, shininess=0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "shadow"


def add_shadow(spec: mujoco.MjSpec, caster: str, radius_m: float, tint: str = "#000000") -> None:
    """Add a spot under `caster` (an arm, whose tool casts it, or a body); at `radius_m` it has faded away."""
    spot = spec.worldbody.add_body(name=f"{caster}/shadow", mocap=True)
    spot.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=(radius_m, radius_m, 0.1),
        pos=(0, 0, _Z_M),
        material="shadow",
        rgba=(*0.5 * rgba(tint)[:3], _ALPHA),
        contype=0,
        conaffinity=0,
    )


def _spot() -> NDArray[np.uint8]:
    """Draw a white spot, shape (rows, columns, 4), opaque in the middle and fading to nothing."""
    axis = np.linspace(-1, 1, _PIXELS)
    radius = np.hypot(*np.meshgrid(axis, axis))
    fade = np.clip(1.0 - radius, 0.0, 1.0)
    image = np.ones((_PIXELS, _PIXELS, 4))
    image[..., 3] = _DARKNESS * fade * fade * (3 - 2 * fade)
    return (255 * image).round().astype(np.uint8)
