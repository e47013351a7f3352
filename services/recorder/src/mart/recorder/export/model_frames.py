"""Open the model that an episode carries, for whoever shows the episode in 3D."""

from __future__ import annotations

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import NotFound
from mart.render.compiled_model import load_model
from mart.render.visual_geoms import BodyFrames


def frames_of(file: EpisodeFile) -> BodyFrames | None:
    """Return the frames of an episode's model, None where it carries none. Raises Corrupt where it is damaged."""
    room = file.room
    try:
        mjb = file.model()
    except NotFound:
        return None
    if not room.model_sha256:
        return None
    version = room.mujoco_version or "an unknown version"
    return BodyFrames(
        load_model(mjb, sha256=room.model_sha256, mujoco_version=version, source=str(file.path))
    )
