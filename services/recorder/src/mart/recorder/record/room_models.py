"""Ask each room's sim for its compiled model, once."""

from __future__ import annotations

import logging
import threading
from hashlib import sha256

from mart.protocol import keys
from mart.protocol.errors import MartError
from mart.protocol.messages import Model
from mart.protocol.received import decode_received
from mart.runtime.bus import Bus

_log = logging.getLogger(__name__)

_MAX_HELD = 16
_TIMEOUT_S = 10.0


class RoomModels:
    """Keep the models of rooms, each of one run of a room's sim, told by `boot`. Safe for several threads."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._held: dict[tuple[str, int], Model] = {}
        self._lock = threading.Lock()

    def known(self, room: str, boot: int) -> Model | None:
        """Return the model, if it has been fetched."""
        with self._lock:
            return self._held.get((room, boot))

    def fetch(self, room: str, boot: int) -> Model | None:
        """Return the model, asking the room's sim unless it is known; None, and a line in the log, where that fails."""
        known = self.known(room, boot)
        if known is not None:
            return known
        try:
            model = decode_received(Model, self._bus.query(keys.model(room), b"", _TIMEOUT_S))
        except MartError as error:
            _log.warning("The model of %s is not to be had: %s", room, error)
            return None
        if sha256(model.mjb).hexdigest() != model.sha256:
            _log.warning("%s sent a model that is not what its checksum says; it is not used", room)
            return None
        with self._lock:
            self._held[room, boot] = model
            while len(self._held) > _MAX_HELD:
                del self._held[next(iter(self._held))]
        return model
