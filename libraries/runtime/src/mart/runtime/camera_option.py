"""Ask on the command line for a room's cameras, and for what each is captured from."""

from __future__ import annotations

import click

from mart.protocol.cameras import MAX_CAMERAS, camera_id
from mart.protocol.errors import InvalidInput


def _chosen(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> dict[str, str]:
    """Return the source of each camera by its id; empty where it was only named.

    Raises InvalidInput for a name that is not allowed or was given twice. No sentence repeats a source: it may hold a
    password.
    """
    chosen: dict[str, str] = {}
    for text in given:
        name, _, source = text.partition("=")
        camera = camera_id(name)
        if camera in chosen:
            raise InvalidInput(f"--camera was given twice for {name}; leave one out.")
        chosen[camera] = source
    if len(chosen) > MAX_CAMERAS:
        raise InvalidInput(f"{len(chosen)} cameras were given; {MAX_CAMERAS} are allowed.")
    return chosen


cameras_option = click.option(
    "--camera",
    "cameras",
    multiple=True,
    metavar="NAME[=SOURCE]",
    callback=_chosen,
    help="A real camera: arm0, arm0.wrist or table. SOURCE: /dev/video0, rtsp://…, a video file, or @FILE that holds "
    "it. Can be given again.",
)
