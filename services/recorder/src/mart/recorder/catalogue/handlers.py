"""Answer questions about recorded episodes, one at a time. For one thread."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from mart.episodes import datasets, labels
from mart.episodes.hand_faults import HandFaults
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.labels import Label, LabelKind
from mart.episodes.reader import EpisodeFile, RecordedMessage
from mart.protocol import clock, codec
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import CatalogueReply, CatalogueRequest, Command, Event, RecordedView, State
from mart.protocol.recording import (
    EVENT,
    VERSIONS,
    CadenceRecord,
    VerificationRecord,
    command_topic,
    video_topic,
)
from mart.protocol.tasks import SHARED_VIEWPOINT
from mart.recorder.catalogue import (
    dataset_editing,
    edit_handlers,
    episode_editing,
    pictures,
    quality_answers,
)
from mart.recorder.catalogue.dataset_editing import DataSetEdit
from mart.recorder.catalogue.drawings import Drawings
from mart.recorder.catalogue.edit_messages import edited_message, edits_message
from mart.recorder.catalogue.episode_editing import EditedEpisode
from mart.recorder.catalogue.episode_scenes import EpisodeScenes
from mart.recorder.catalogue.kept_files import KeptFiles
from mart.recorder.catalogue.listing import episode_message, filter_of, listing
from mart.recorder.catalogue.live_listing import LiveListing
from mart.recorder.catalogue.quality_measurer import QualityMeasurer
from mart.recorder.catalogue.timeline import timeline

PIECE_BYTES = 1024 * 1024
_MAX_PICTURES = 64  # of some 20 kB
_CLOCKS_DIFFER_NS = 1_000_000_000


class CatalogueHandlers:
    """Answer what is asked about the episodes in the folder `root`; of what is there, only labels ever change.

    render_log: what the processes that draw videos print; beside the folder, in `logs`, where it is not given.
    quality: is told what is listed, and knows how well it was recorded.
    """

    def __init__(
        self, root: Path, render_log: Path | None = None, quality: QualityMeasurer | None = None
    ) -> None:
        self._root = root
        self._quality = quality or QualityMeasurer()
        self._drawings = Drawings(render_log or root.parent / "logs" / "render.log")
        self._rows: dict[str, LabelledEpisode] = {}
        self._listing = LiveListing(root)
        self._pictures: OrderedDict[str, bytes] = OrderedDict()
        self._videos = KeptFiles(root)
        self._scenes = EpisodeScenes(root)
        self._handlers: dict[str, Callable[[Any], CatalogueReply]] = {
            "list": self._list,
            "show": lambda asked: CatalogueReply(details=self._details(asked.path)),
            "label": lambda asked: CatalogueReply(episode=episode_message(self._label(asked))),
            "file": lambda asked: CatalogueReply(piece=self._file_piece(asked)),
            "video": lambda asked: CatalogueReply(piece=self._video_piece(asked)),
            "picture": lambda asked: CatalogueReply(piece=_piece(self._picture(asked.path), 0)),
            "curate": lambda asked: self._edited(self._edit(asked)),
            "undo": lambda asked: self._edited(self._undo(asked)),
            "compare_quality": self._compare_quality,
            "show_quality": self._show_quality,
            "edit": lambda asked: self._told(edit_handlers.edit(self._row(asked.path), asked)),
            "undo_edit": lambda asked: self._told(edit_handlers.undo(self._row(asked.path), asked)),
            "scene": lambda asked: CatalogueReply(piece=self._scenes.scene(self._file(asked.path), asked)),
            "motion": lambda asked: CatalogueReply(piece=self._scenes.motion(self._file(asked.path), asked)),
        }

    def answer(self, request: CatalogueRequest) -> CatalogueReply:
        """Answer one request. Raises NotFound, InvalidInput, Corrupt or Conflict."""
        what = request.WhichOneof("what")
        if what is None:
            raise InvalidInput(f"An empty request was given; ask for one of {', '.join(self._handlers)}.")
        return self._handlers[what](getattr(request, what))

    def close(self) -> None:
        """End what is being drawn, and forget what was."""
        self._listing.close()
        self._drawings.close()

    def _list(self, asked: CatalogueRequest.List) -> CatalogueReply:
        self._refresh()
        held = datasets.named(labels.read_folded(self._root)).values()
        found = listing(self._rows_for(asked), asked, held)
        found.files_read, found.files_to_read = self._listing.progress or (0, 0)
        for one in found.episodes:
            quality_answers.with_outliers(one, self._quality.known)
        return CatalogueReply(listing=found)

    def _rows_for(self, asked: CatalogueRequest.List) -> list[LabelledEpisode]:
        rows = list(self._rows.values())
        return quality_answers.only_outliers(self._quality.known, rows) if asked.outliers else rows

    def _compare_quality(self, asked: CatalogueRequest.CompareQuality) -> CatalogueReply:
        self._refresh()
        found = quality_answers.comparison(self._quality.known, list(self._rows.values()), asked)
        return CatalogueReply(quality_comparison=found)

    def _show_quality(self, asked: CatalogueRequest.ShowQuality) -> CatalogueReply:
        found = quality_answers.details(self._quality.known, self._row(asked.path).path)
        return CatalogueReply(quality_details=found)

    def _refresh(self) -> None:
        self._rows = self._listing.rows()
        self._quality.see(list(self._rows.values()))

    def _row(self, path: str) -> LabelledEpisode:
        """Return the episode at a path that is listed; no other can be asked for, so none leads out of the folder."""
        if path not in self._rows:
            self._rows = self._listing.rows(anew=True)
        if path not in self._rows:
            raise NotFound(f"There is no episode {path[:200]!r}; the list shows those that there are.")
        return self._rows[path]

    def _file(self, path: str) -> EpisodeFile:
        return EpisodeFile.open(self._row(path).file_path)

    def _details(self, path: str) -> CatalogueReply.Details:
        file = self._file(path)
        views = _views(file)
        events, faults = _said(file)
        details = timeline(_each_tick_once(file), events, faults, None if views else file.room.control_hz)
        known = episode_editing.as_it_is(self._rows[path])
        details.episode.CopyFrom(episode_message(known.episode))
        details.edits.CopyFrom(edits_message(known))
        details.views.extend(views)
        details.viewpoints.extend(_viewpoints(file) if details.traces else ())
        details.cadence.update(file.metadata.get(CadenceRecord.NAME, {}))
        details.versions.update(file.metadata.get(VERSIONS, {}))
        details.verification = file.metadata.get(VerificationRecord.NAME, {}).get("detail", "")
        return details

    def _label(self, asked: CatalogueRequest.Label) -> LabelledEpisode:
        row, now_ns = self._row(asked.path), clock.wall_ns()
        said: dict[LabelKind, str] = {}
        if asked.HasField("outcome"):
            said[LabelKind.OUTCOME] = asked.outcome
        if asked.HasField("note"):
            said[LabelKind.NOTE] = asked.note
        if asked.HasField("dropped"):
            said[LabelKind.USE] = labels.DROP if asked.dropped else labels.KEEP
        if not said:
            raise InvalidInput("Nothing to say was given; say an outcome, a note, or whether to drop it.")
        labels.append(
            self._root, [Label(row.path, kind, value, now_ns, by=asked.by) for kind, value in said.items()]
        )
        row = row.with_labels(labels.read_folded(self._root).get(row.path))
        self._rows[row.path] = row
        return row

    def _edit(self, asked: CatalogueRequest.Curate) -> DataSetEdit:
        self._refresh()
        known, now_ns = list(self._rows.values()), clock.wall_ns()
        by_filter = asked.HasField("all")
        if by_filter == bool(asked.paths):
            raise InvalidInput("Name the episodes, or give a filter that lets them through: one of the two.")
        chosen = (
            filter_of(asked.all).apply(self._rows_for(asked.all))
            if by_filter
            else map(self._row, asked.paths)
        )
        if asked.take_out:
            return dataset_editing.take_out(
                self._root, asked.dataset, [row.path for row in chosen], now_ns, asked.by
            )
        return dataset_editing.take_in(self._root, asked.dataset, chosen, known, now_ns=now_ns, by=asked.by)

    def _undo(self, asked: CatalogueRequest.Undo) -> DataSetEdit:
        return dataset_editing.undo(self._root, asked.dataset, asked.act_ns, clock.wall_ns(), asked.by)

    def _edited(self, done: DataSetEdit) -> CatalogueReply:
        curated = CatalogueReply.Curated(
            dataset=done.dataset.name,
            changed=done.changed,
            left_out=done.left_out,
            episodes=len(done.dataset.episodes),
            act_ns=done.act_ns,
        )
        return CatalogueReply(curated=curated)

    def _told(self, done: EditedEpisode) -> CatalogueReply:
        self._rows[done.episode.path] = done.episode
        return CatalogueReply(edited=edited_message(done))

    def _file_piece(self, asked: CatalogueRequest.File) -> CatalogueReply.Piece:
        return _file_piece(self._row(asked.path).file_path, asked.offset)

    def _video_piece(self, asked: CatalogueRequest.Video) -> CatalogueReply.Piece:
        path, camera = asked.path, asked.camera
        file = self._file(path)
        if next(iter(file.messages(video_topic(camera))), None) is None:
            return self._drawn_piece(file, camera, asked.offset)

        def make(out: BinaryIO) -> None:
            pictures.write_mp4(pictures.frames_of(file, camera), out)

        piece, size_bytes = self._videos.piece((path, camera), make, asked.offset, PIECE_BYTES)
        return CatalogueReply.Piece(piece=piece, size_bytes=size_bytes)

    def _drawn_piece(self, file: EpisodeFile, viewpoint: str, offset: int) -> CatalogueReply.Piece:
        if viewpoint not in _viewpoints(file):
            raise NotFound.named("viewpoint", viewpoint, _viewpoints(file))
        video = self._drawings.video(file, viewpoint)
        return CatalogueReply.Piece(pending=True) if video is None else _file_piece(video, offset)

    def _picture(self, path: str) -> bytes:
        if path not in self._pictures:
            self._pictures[path] = self._draw(path)
        self._pictures.move_to_end(path)
        while len(self._pictures) > _MAX_PICTURES:
            self._pictures.popitem(last=False)
        return self._pictures[path]

    def _draw(self, path: str) -> bytes:
        file = self._file(path)
        for camera in _recorded_cameras(file):
            try:
                return pictures.last_picture(pictures.frames_of(file, camera))
            except NotFound:
                continue
        return self._drawings.still(file)


def _said(file: EpisodeFile) -> tuple[list[Event], HandFaults]:
    """Return what people and services said, and when hands were not known, in one reading."""
    events, faults = [], HandFaults()
    for message in file.messages(EVENT, *map(command_topic, file.episode.arms)):
        if message.topic == EVENT:
            events.append(codec.decode(Event, message.payload))
        else:
            faults.add(codec.decode(Command, message.payload))
    return events, faults


def _each_tick_once(file: EpisodeFile) -> Iterator[State]:
    newest = -1
    for state in file.steady_states():
        if state.tick > newest:
            newest = state.tick
            yield state


def _views(file: EpisodeFile) -> list[RecordedView]:
    """Return when the video of each camera begins that is in the file, since the first state was there."""
    first = next(file.states(), None)
    if first is None:
        return []
    start_ns = first.stamps.stepped_ns
    cameras = {video_topic(camera): camera for camera in _recorded_cameras(file)}
    first_ns: dict[str, int] = {}
    for message in file.messages(*cameras) if cameras else ():
        first_ns.setdefault(cameras[message.topic], _shown_ns(message))
    return [
        RecordedView(camera=camera, start_s=(first_ns[camera] - start_ns) / 1e9)
        for camera in cameras.values()
        if camera in first_ns
    ]


def _shown_ns(message: RecordedMessage) -> int:
    """Return when a picture was made; where its machine's clock is another, when it came."""
    is_near = abs(message.arrived_ns - message.sent_ns) < _CLOCKS_DIFFER_NS
    return message.sent_ns if is_near else message.arrived_ns


def _recorded_cameras(file: EpisodeFile) -> tuple[str, ...]:
    """Return whose pictures may be in the file: each arm's, drawn or captured, and those of other real cameras."""
    return tuple(dict.fromkeys([*file.episode.arms, *(file.episode.captured_cameras or ())]))


def _viewpoints(file: EpisodeFile) -> tuple[str, ...]:
    """Return the viewpoints that every model of ours has."""
    return (SHARED_VIEWPOINT, *file.episode.arms)


def _file_piece(path: Path, offset: int) -> CatalogueReply.Piece:
    size = path.stat().st_size
    with path.open("rb") as file:
        file.seek(min(offset, size))
        return CatalogueReply.Piece(piece=file.read(PIECE_BYTES), size_bytes=size)


def _piece(whole: bytes, offset: int) -> CatalogueReply.Piece:
    return CatalogueReply.Piece(piece=whole[offset : offset + PIECE_BYTES], size_bytes=len(whole))
