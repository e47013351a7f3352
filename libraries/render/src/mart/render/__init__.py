"""Draw pictures of a MuJoCo world without a display: the one renderer of the environments, videos and live views.

>>> with closing(Renderer(model, "front", width_px=640, height_px=480)) as renderer:
...     picture = renderer.draw(integration_state)  # uint8, shape (480, 640, 3)
"""

from __future__ import annotations

from mart.render.compiled_model import load_model, viewpoint_id
from mart.render.moving_bodies import BodyPoses
from mart.render.renderer import Image, Renderer
from mart.render.scene_export import PageScene, export_scene
from mart.render.state_pictures import PictureSpec, StatePictures

__all__ = [
    "BodyPoses",
    "Image",
    "PageScene",
    "PictureSpec",
    "Renderer",
    "StatePictures",
    "export_scene",
    "load_model",
    "viewpoint_id",
]
