"""Examples here write files: how long one takes says more about the disk than about the code."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("files", deadline=None)
settings.load_profile("files")
