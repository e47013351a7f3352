"""A request that is asked again, because its answer was lost on the way, is done once."""

from __future__ import annotations

import threading
import weakref
from collections import OrderedDict
from typing import Protocol

_REMEMBERED = 64
_LARGEST_BYTES = 64 * 1024  # what reads much may read it again; who changes something answers briefly


class Asker(Protocol):
    """One of those who wait for the answer to a request: the same one may, over several links."""

    def answer(self, payload: bytes) -> None: ...


class Repetitions:
    """Remember the answers of one served key; its methods may be called from any thread.

    A request is in progress as long as somebody holds it: one that was let go without an answer is done anew.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._in_progress: weakref.WeakValueDictionary[bytes, AskedOnce] = weakref.WeakValueDictionary()
        self._answers: OrderedDict[bytes, bytes] = OrderedDict()

    def ask(self, id: bytes, key: str, payload: bytes, asker: Asker) -> AskedOnce | None:
        """The request to work on; None where it is a repetition: its asker has, or will get, the first one's answer."""
        with self._lock:
            answer = self._answers.get(id)
            if answer is None:
                request = self._in_progress.get(id)
                if request is not None:
                    request.askers.append(asker)
                    return None
                request = AskedOnce(self, id, key, payload, asker)
                if id:
                    self._in_progress[id] = request
                return request
        asker.answer(answer)
        return None

    def answered(self, request: AskedOnce, payload: bytes) -> list[Asker]:
        """Remembers; returns those who wait for it."""
        with self._lock:
            self._in_progress.pop(request.id, None)
            if request.id and len(payload) <= _LARGEST_BYTES:
                self._answers[request.id] = payload
                if len(self._answers) > _REMEMBERED:
                    self._answers.popitem(last=False)
            return request.askers


class AskedOnce:
    """A `Request` that answers everybody who asked it."""

    def __init__(self, repetitions: Repetitions, id: bytes, key: str, payload: bytes, asker: Asker) -> None:
        self.id, self.key, self.payload = id, key, payload
        self.askers = [asker]
        self._repetitions = repetitions

    def reply(self, payload: bytes) -> None:
        for asker in self._repetitions.answered(self, payload):
            asker.answer(payload)
