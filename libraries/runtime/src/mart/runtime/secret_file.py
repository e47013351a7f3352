"""Keep the secret that signs and checks seat tokens: made at first use, readable by its owner alone."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

from mart.protocol.errors import InvalidInput

_SECRET_BYTES = 32


def load_or_create_secret(path: Path) -> bytes:
    """Return the secret at `path`, made at first use with mode 0600; raises InvalidInput where it is too short."""
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        pass
    else:
        with os.fdopen(handle, "w") as file:
            file.write(secrets.token_hex(_SECRET_BYTES))
    secret = path.read_text().strip().encode()
    if len(secret) < _SECRET_BYTES:
        raise InvalidInput(
            f"The secret in {path} has {len(secret)} characters; at least {_SECRET_BYTES} are needed: delete the file."
        )
    return secret
