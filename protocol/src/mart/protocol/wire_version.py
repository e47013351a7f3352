"""Number the versions of what the parts say to each other; different ones do not work together."""

from __future__ import annotations

DRIVER_WIRE_VERSION = 1
BUS_WIRE_VERSION = 1  # of everything else on the bus; a router with certificates tells it to whom it admits
