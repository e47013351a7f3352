"""Define colours and materials of the scene.

A thing is made of a material: `add_geom(…, material="walnut")`. What belongs to an arm is painted in its colour:
`add_geom(…, material="paint", rgba=rgba(arm.color))`; a geom's own rgba replaces the material's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Material:
    """Describe a material: `color` is sRGB hex; `gloss` how strong a highlight is, `shininess` how small, 0 to 1.

    An `alpha` below 1 is drawn last and blended: keep it to small things, since software rendering pays for each pixel.
    """

    color: str
    gloss: float = 0.0
    shininess: float = 0.0
    alpha: float = 1.0


MATERIALS: Mapping[str, Material] = {
    # The room and the arms.
    "floor": Material("#FFFFFF"),  # these three have pictures
    "rug": Material("#FFFFFF"),
    "table": Material("#FFFFFF"),
    "edge": Material("#8A6B4C"),
    "metal": Material("#4A525A", gloss=0.3, shininess=0.3),
    "shell": Material("#F1F2F3", gloss=0.35, shininess=0.5),
    "rubber": Material("#2E3236", gloss=0.1, shininess=0.1),
    # What things are made of. Paint and plastic are there to be given a colour.
    "paint": Material("#FFFFFF", gloss=0.25, shininess=0.4),
    "plastic": Material("#E9E6DF", gloss=0.45, shininess=0.7),
    "oak": Material("#D2AB76", gloss=0.10, shininess=0.2),
    "walnut": Material("#7D573B", gloss=0.15, shininess=0.3),
    "steel": Material("#AEB6BD", gloss=0.7, shininess=0.6),
    "brass": Material("#C8A04A", gloss=0.7, shininess=0.5),
    "ceramic": Material("#F5F1E8", gloss=0.6, shininess=0.8),
    "glass": Material("#CFE8F0", gloss=0.9, shininess=0.9, alpha=0.40),
    "juice": Material("#E8912D", gloss=0.3, shininess=0.6),
    "sponge": Material("#F0C84B"),
    "linen": Material("#E6DAC3"),
    "clay": Material("#B4694A"),
    "slate": Material("#5E6B78"),
    "dirt": Material("#5C4329"),
}


def rgba(color: str, alpha: float = 1.0) -> NDArray[np.float64]:
    """Return `#RRGGBB` as four numbers in [0, 1]."""
    return np.array([*(int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)), alpha])


def add_materials(spec: mujoco.MjSpec) -> None:
    """Add every material of the palette."""
    for name, material in MATERIALS.items():
        spec.add_material(
            name=name,
            rgba=rgba(material.color, material.alpha),
            specular=material.gloss,
            shininess=material.shininess,
        )
