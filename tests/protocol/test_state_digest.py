"""The digest by which a re-simulation is compared with a recording stays what files and replicas agree on."""

from __future__ import annotations

import hashlib

from mart.protocol.state_digest import DIGEST_BYTES, state_digest


def test_a_digest_is_blake2b_of_sixteen_bytes() -> None:
    assert state_digest(b"state") == hashlib.blake2b(b"state", digest_size=16).digest()
    assert len(state_digest(b"")) == DIGEST_BYTES
