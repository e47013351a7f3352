"""Answer what a page needs to draw an episode by itself: its model's scene once, and its motion. For one thread."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import NotFound
from mart.protocol.messages import CatalogueReply, CatalogueRequest
from mart.recorder.catalogue.kept_files import KeptFiles
from mart.recorder.catalogue.motion import write_motion

if TYPE_CHECKING:
    import mujoco

PIECE_BYTES = 1024 * 1024


class EpisodeScenes:
    """Make scenes and motions when they are asked for, and keep them in files that vanish with this process.

    folder: on whose disk they are.
    """

    def __init__(self, folder: Path) -> None:
        self._kept = KeptFiles(folder)
        self._digests: dict[str, str] = {}  # model → scene, both SHA-256: one for each model of the folder
        self._model: tuple[str, mujoco.MjModel] | None = None  # the newest: most episodes share it

    def scene(self, file: EpisodeFile, asked: CatalogueRequest.Scene) -> CatalogueReply.Piece:
        """Return a piece of the scene, and its digest; no bytes where that is known.

        Raises NotFound where the file has no model, Corrupt where it is damaged, InvalidInput where pages cannot draw
        it.
        """
        sha256 = self._scene_sha256(file)
        if sha256 in asked.known_sha256:
            return CatalogueReply.Piece(sha256=sha256)
        piece, size_bytes = self._scene_piece(file, asked.offset)
        return CatalogueReply.Piece(piece=piece, size_bytes=size_bytes, sha256=sha256)

    def motion(self, file: EpisodeFile, asked: CatalogueRequest.Motion) -> CatalogueReply.Piece:
        """Return a piece of where the bodies are in every tick; raises as `scene` and `write_motion` do."""
        from mart.render import BodyPoses

        sha256 = self._scene_sha256(file)

        def make(out: BinaryIO) -> None:
            poses = BodyPoses(self._model_of(file), sha256)
            control_hz = file.room.control_hz if asked.simulated else None
            write_motion(file.steady_states(), poses, control_hz, out, file.episode.ticks or 0)

        key = ("motion", asked.path, str(asked.simulated))
        piece, size_bytes = self._kept.piece(key, make, asked.offset, PIECE_BYTES)
        return CatalogueReply.Piece(piece=piece, size_bytes=size_bytes)

    def _scene_sha256(self, file: EpisodeFile) -> str:
        model_sha256 = file.room.model_sha256 or ""
        if model_sha256 not in self._digests:
            self._scene_piece(file, 0)
        return self._digests[model_sha256]

    def _scene_piece(self, file: EpisodeFile, offset: int) -> tuple[bytes, int]:
        model_sha256 = file.room.model_sha256 or ""

        def make(out: BinaryIO) -> None:
            from mart.render import export_scene

            scene = export_scene(self._model_of(file))
            out.write(gzip.compress(scene.data, compresslevel=6, mtime=0))
            self._digests[model_sha256] = scene.sha256

        return self._kept.piece(("scene", model_sha256), make, offset, PIECE_BYTES)

    def _model_of(self, file: EpisodeFile) -> mujoco.MjModel:
        # Here, not above: whoever only lists episodes needs no MuJoCo.
        from mart.render import load_model

        sha256 = file.room.model_sha256 or ""
        if self._model is None or self._model[0] != sha256:
            try:
                mjb = file.model()
            except NotFound as error:
                raise NotFound(
                    "This episode's file holds no model, so it cannot be shown in 3D; its videos can be watched."
                ) from error
            version = file.room.mujoco_version or "an unknown version"
            self._model = (
                sha256,
                load_model(mjb, sha256=sha256, mujoco_version=version, source=file.path.name),
            )
        return self._model[1]
