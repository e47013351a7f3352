"""Drive the simulated hardware."""

from __future__ import annotations

import json
import socket

import numpy as np

from mart.driver.interface import Array, Driver, DriverFault, Measured
from mart.protocol.errors import InvalidInput

_CONNECT_TIMEOUT_S = 2.0
_MAX_LINE_BYTES = 65536


class SimulatedArm(Driver):
    """Speak to simulated hardware at `address` (HOST:PORT), of a kind of arm with so many joints."""

    rate_hz = 125.0

    def __init__(self, address: str, kind: str = "panda", joints: str = "7") -> None:
        host, _, port = address.rpartition(":")
        if not host or not port.isdigit():
            raise InvalidInput(f"address={address!r} was given; write HOST:PORT.")
        self.kind, self.joint_count = kind, int(joints)
        self._address = (host, int(port))
        self._socket: socket.socket | None = None
        self._received = b""
        self._newest: Measured | None = None

    def connect(self) -> None:
        """Open the connection, and wait for a first reading."""
        try:
            self._socket = socket.create_connection(self._address, _CONNECT_TIMEOUT_S)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._received, self._newest = b"", None
            while not self._take(self._socket.recv(_MAX_LINE_BYTES)):
                pass
            self._socket.setblocking(False)
        except OSError as error:
            raise DriverFault(
                f"The hardware at {self._address[0]}:{self._address[1]} cannot be reached: {error}."
            ) from error

    def read(self) -> Measured:
        """Return the newest reading that has come."""
        try:
            while True:
                self._take(self._connected().recv(_MAX_LINE_BYTES))
        except BlockingIOError:
            pass
        except OSError as error:
            raise DriverFault(f"The connection to the hardware was lost: {error}.") from error
        assert self._newest is not None  # `connect` waited for it
        return self._newest

    def servo(self, joint_positions: Array, gripper: float) -> None:
        """Send where the joints are to be next."""
        self._send({"servo": joint_positions.tolist(), "gripper": gripper})

    def stop(self) -> None:
        """Let it stand still where it is."""
        self._send({"stop": True})

    def close(self) -> None:
        """Close the connection; the hardware then stands still by itself."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _connected(self) -> socket.socket:
        if self._socket is None:
            raise DriverFault("The hardware is not connected.")
        return self._socket

    def _send(self, message: object) -> None:
        try:
            self._connected().sendall(json.dumps(message).encode() + b"\n")
        except OSError as error:
            raise DriverFault(f"The connection to the hardware was lost: {error}.") from error

    def _take(self, piece: bytes) -> bool:
        """Take what came; return whether there was a reading in it."""
        if not piece:
            raise DriverFault("The hardware closed the connection.")
        *lines, self._received = (self._received + piece).split(b"\n")
        if len(self._received) > _MAX_LINE_BYTES:
            raise DriverFault("The hardware sends lines without end.")
        if not lines:
            return False
        try:
            said = json.loads(lines[-1])
            joints = np.array(said["joints"], dtype=np.float64)
            self._newest = Measured(said["stamp_s"], joints, said["gripper"], fault=said["fault"])
        except (ValueError, KeyError, TypeError) as error:
            raise DriverFault(f"The hardware sent what is no reading: {error}.") from error
        return True
