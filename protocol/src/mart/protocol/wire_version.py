"""Number the versions of what a room and a driver say to each other; different ones do not work together."""

from __future__ import annotations

DRIVER_WIRE_VERSION = 1
