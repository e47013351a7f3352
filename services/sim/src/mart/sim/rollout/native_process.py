"""Answer re-simulations in a process that computes with the C library's own choice for this processor.

Services compute with fused multiply-add switched off (`mart.runtime.steady_libm`). Version 0.1 did not, nor does a
program of your own, so what they recorded can only be stepped again to the same bits in a process like theirs. It is
started when it is first needed and ends when it was idle for a minute. Requests and replies go over its standard input
and output, each with its length before it.
"""

from __future__ import annotations

import struct
import subprocess
import sys
import threading
from collections.abc import Mapping
from typing import IO

from mart.protocol import codec
from mart.protocol.errors import Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest, raise_error
from mart.runtime.child_process import STANDARD_ERROR, start_child
from mart.runtime.steady_libm import native_environment

_IDLE_S = 60.0
_LENGTH = struct.Struct("<I")


class NativeRollouts:
    """Hold the process while it is needed.

    environment: of this process; where it computes natively itself, nothing is started, and `is_needed` is false.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = native_environment(environment)
        self._process: subprocess.Popen[bytes] | None = None
        self._idle: threading.Timer | None = None
        self._lock = threading.Lock()

    @property
    def is_needed(self) -> bool:
        """Whether a process of its own computes otherwise than this one."""
        return self._environment is not None

    def ask(self, request: RolloutRequest) -> RolloutReply:
        """Return the process's answer. Raises what the answer says, Unavailable where it has died over the request."""
        with self._lock:
            if self._idle is not None:
                self._idle.cancel()
            try:
                reply = self._exchange(codec.encode(request))
            except OSError as error:
                self._end()
                raise Unavailable(f"The process that steps natively has died: {error}.") from error
            self._idle = threading.Timer(_IDLE_S, self.close)
            self._idle.daemon = True
            self._idle.start()
        raise_error(reply.error)
        return reply

    def close(self) -> None:
        """End the process, if there is one."""
        with self._lock:
            self._end()

    def _exchange(self, payload: bytes) -> RolloutReply:
        if self._process is None:
            command = [sys.executable, "-m", __name__]
            self._process = start_child(command, STANDARD_ERROR, self._environment or {}, piped=True)
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        _write(process.stdin, payload)
        answer = _read(process.stdout)
        if answer is None:
            raise BrokenPipeError("it ended without an answer")
        return codec.decode(RolloutReply, answer, codec.MAX_MESSAGE_BYTES)

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()


def _serve(requests: IO[bytes], replies: IO[bytes]) -> None:
    from mart.sim.rollout.replica import rollout_answerer
    from mart.sim.rollout.rollout_server import RolloutServer

    answer = rollout_answerer(RolloutServer(threads=1))
    while (payload := _read(requests)) is not None:
        _write(replies, answer(payload))


def _write(pipe: IO[bytes], payload: bytes) -> None:
    pipe.write(_LENGTH.pack(len(payload)) + payload)
    pipe.flush()


def _read(pipe: IO[bytes]) -> bytes | None:
    """Return the next payload; None at the end."""
    head = pipe.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(head)
    payload = pipe.read(length)
    return payload if len(payload) == length else None


if __name__ == "__main__":
    _serve(sys.stdin.buffer, sys.stdout.buffer)
