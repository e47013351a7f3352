"""Draw several pictures of a world at once, by name: what a policy that sees is shown."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass

import mujoco

from mart.render.renderer import Image, Renderer


@dataclass(frozen=True)
class PictureSpec:
    """Say from which of a task's viewpoints a picture is drawn, and how large."""

    viewpoint: str
    width_px: int
    height_px: int


class StatePictures:
    """Draw the pictures of these specs, by their names. Build, use and close it on one thread, as a `Renderer`."""

    def __init__(self, model: mujoco.MjModel, specs: Mapping[str, PictureSpec]) -> None:
        """Raise as `Renderer` does."""
        with ExitStack() as opened:
            self._renderers = {
                name: opened.enter_context(
                    closing(Renderer(model, one.viewpoint, one.width_px, one.height_px))
                )
                for name, one in specs.items()
            }
            self._opened = opened.pop_all()

    def draw(self, integration_state: bytes) -> dict[str, Image]:
        """Return by name uint8[height, width, 3] of this state, sRGB. Raises InvalidInput as `Renderer.draw`."""
        return {name: renderer.draw(integration_state) for name, renderer in self._renderers.items()}

    def close(self) -> None:
        """Give back what was held of the graphics card."""
        self._opened.close()
