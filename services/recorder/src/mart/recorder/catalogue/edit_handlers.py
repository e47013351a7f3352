"""Answer requests to edit one episode, and to take edits back."""

from __future__ import annotations

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol import clock
from mart.protocol.messages import CatalogueRequest
from mart.recorder.catalogue import episode_editing
from mart.recorder.catalogue.edit_messages import edits_of
from mart.recorder.catalogue.episode_editing import EditedEpisode


def edit(row: LabelledEpisode, asked: CatalogueRequest.EditEpisode) -> EditedEpisode:
    """Say what is asked of an episode; where nothing is, tell how it is edited. Raises InvalidInput."""
    said = edits_of(asked.edits)
    if asked.skip_idle_s:
        said += episode_editing.idle_skips(row, asked.skip_idle_s)
    return episode_editing.edit(row, said, clock.wall_ns(), asked.by)


def undo(row: LabelledEpisode, asked: CatalogueRequest.UndoEdit) -> EditedEpisode:
    """Take back an act of an episode. Raises NotFound where it does not hold."""
    return episode_editing.undo(row, asked.act_ns or None, clock.wall_ns(), asked.by)
