"""Paint a seat's picture: of the world, drawn from a state, or of a camera, as it was captured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import cv2
import mujoco

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import State
from mart.protocol.tasks import Ghost
from mart.render import Image
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.captured_pictures import decode_picture, fit_into
from mart.teleop_gateway.video.quality import Quality
from mart.teleop_gateway.video.seat_renderer import SeatRenderer

GhostIn = Callable[[State], Ghost | None]

_DIMMED = 0.3
_LETTERS = cv2.FONT_HERSHEY_SIMPLEX
_LETTERS_AT_640 = 0.8
_THICK = 2


@dataclass(frozen=True)
class CapturedPicture:
    """Hold a camera's picture. jpeg: empty where it never gave one. notice: why it is an old one; empty: it is not."""

    jpeg: bytes
    notice: str = ""


@dataclass(frozen=True)
class UnpaintedPicture:
    """Hold what has not been painted. tick: that it shows. image_ns: when the world, or the table, looked so.

    received_ns: of a state, when it came to the gateway; of a capture, when it was captured, by this machine's clock.
    """

    content: State | CapturedPicture
    tick: int
    image_ns: int
    received_ns: int

    @classmethod
    def of(cls, state: State, received_ns: int) -> UnpaintedPicture:
        """Return what is to be drawn of a state."""
        return cls(state, state.tick, state.stamps.stepped_ns, received_ns)


class PicturePainter(Protocol):
    """Paint pictures of one size at a time. Made, used and closed on one thread."""

    def resize(self, quality: Quality) -> None:
        """Paint pictures of this quality's size from now on."""

    def paint(self, unpainted: UnpaintedPicture, picture_rgb: Image) -> None:
        """Fill a picture, with its strip. Raises InvalidInput or Corrupt for what cannot be painted."""

    def close(self) -> None:
        """Give back what is held."""


MakePainter = Callable[[Quality], PicturePainter]


class WorldPainter:
    """Draw states of a room's model as its camera sees them; see `world_painter`."""

    def __init__(self, model: mujoco.MjModel, camera: str, quality: Quality, ghost_in: GhostIn) -> None:
        self._renderer = SeatRenderer(model, camera, quality)
        self._ghost_in = ghost_in

    def resize(self, quality: Quality) -> None:
        """Draw pictures of this quality's size from now on."""
        self._renderer.resize(quality)

    def paint(self, unpainted: UnpaintedPicture, picture_rgb: Image) -> None:
        """Draw a state. Raises InvalidInput where it is not one of this model, or is none."""
        state = unpainted.content
        if not isinstance(state, State):
            raise InvalidInput("A captured picture was given to a view that draws.")
        self._renderer.draw(state.integration_state, unpainted.tick, picture_rgb, self._ghost_in(state))

    def close(self) -> None:
        """Give back what the renderer holds."""
        self._renderer.close()


def world_painter(model: mujoco.MjModel, camera: str, ghost_in: GhostIn = lambda _: None) -> MakePainter:
    """Return what makes a painter of this model; ghost_in: what is shown beside what is there."""
    return lambda quality: WorldPainter(model, camera, quality, ghost_in)


class CameraPainter:
    """Show what a camera captured; one that is old is dark, and says so."""

    def __init__(self, quality: Quality) -> None:
        self._quality = quality

    def resize(self, quality: Quality) -> None:
        """Show pictures of this quality's size from now on."""
        self._quality = quality

    def paint(self, unpainted: UnpaintedPicture, picture_rgb: Image) -> None:
        """Show a picture. Raises Corrupt where it is no JPEG, InvalidInput where it is a state."""
        captured = unpainted.content
        if not isinstance(captured, CapturedPicture):
            raise InvalidInput("A state was given to a view that shows a camera.")
        view = picture_rgb[: self._quality.view_height_px]
        if captured.jpeg:
            fit_into(decode_picture(captured.jpeg), view)
        else:
            view[:] = 0
        if captured.notice:
            _write_notice(captured.notice, view)
        tick_code.write(unpainted.tick, picture_rgb[self._quality.view_height_px :])

    def close(self) -> None:
        """Give back nothing: it holds nothing."""


def _write_notice(notice: str, view: Image) -> None:
    """Make a view dark, and write into its middle, as large as it fits."""
    view[:] = (view * _DIMMED).astype(view.dtype)
    rows, columns = view.shape[:2]
    scale = _LETTERS_AT_640 * columns / 640
    (width, height), _ = cv2.getTextSize(notice, _LETTERS, scale, _THICK)
    if width > 0.9 * columns:
        scale *= 0.9 * columns / width
        (width, height), _ = cv2.getTextSize(notice, _LETTERS, scale, _THICK)
    at = (columns - width) // 2, (rows + height) // 2
    cv2.putText(view, notice, at, _LETTERS, scale, (255, 255, 255), _THICK, cv2.LINE_AA)
