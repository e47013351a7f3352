"""Digest integration states: how a re-simulation is compared with a recording, tick by tick."""

from __future__ import annotations

from hashlib import blake2b

DIGEST_BYTES = 16  # a chance of one in 2^128 that another state has the same


def state_digest(integration_state: bytes) -> bytes:
    """Return the BLAKE2b digest of one integration state, `DIGEST_BYTES` long."""
    return blake2b(integration_state, digest_size=DIGEST_BYTES).digest()
