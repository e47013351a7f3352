"""Write log lines: for people as text, for programs as one JSON object a line (MART_LOG_FORMAT=json).

What every line of a process is about (its room, its seat) is said once, by `set_log_context`; what a single line is
about, by logging's own `extra={"room": …, "episode": …}`.
"""

from __future__ import annotations

import json
import logging
import sys
from datetime import UTC, datetime

LOG_FIELDS = (
    "room",
    "seat",
    "episode",
)  # in the order in which they are written; absent where they are not known

_context: dict[str, str | int] = {}


def set_log_context(**fields: str | int) -> None:
    """Say what all further lines of this process are about: its `room`, its `seat`."""
    _context.update(fields)


def configure_logging(level: str, name: str, id: str = "", form: str = "text") -> None:
    """Log one line an entry to standard error.

    As text: time, level, the name of the service, message. As JSON: `time` (RFC 3339, UTC), `level`, `service`, `id`,
    `logger`, `message`, and LOG_FIELDS and `exception` where there are any.
    """
    formatter: logging.Formatter
    if form == "json":
        formatter = _JsonFormatter(name, id)
    else:
        formatter = logging.Formatter(f"%(asctime)s %(levelname)-7s {name:<9} %(message)s")
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(formatter)
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)


class _JsonFormatter(logging.Formatter):
    def __init__(self, service: str, id: str) -> None:
        super().__init__()
        self._service, self._id = service, id

    def format(self, record: logging.LogRecord) -> str:
        """Return the entry as JSON without a line break."""
        at = datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
        entry: dict[str, object] = {
            "time": at.replace("+00:00", "Z"),
            "level": record.levelname,
            "service": self._service,
            "id": self._id,
            "logger": record.name,
            "message": record.getMessage(),
        }
        for field in LOG_FIELDS:
            value = getattr(record, field, _context.get(field))
            if value is not None:
                entry[field] = value
        if record.exc_info:
            entry["exception"] = self.formatException(record.exc_info)
        return json.dumps(entry, ensure_ascii=False, default=str)
