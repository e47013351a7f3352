"""Know whether somebody keeps the episode that goes on, from what recorders report. Pure.

Times are monotonic seconds.
"""

from __future__ import annotations

from collections import deque

from mart.protocol.messages import RecordingReport

_NOTICE_AFTER_S = 2.0
UNKEPT_AFTER_S = 0.4  # a recorder reports every 0.1 s


class RecordingWatch:
    """Compare the states that were told in an episode with those that a recorder says it has."""

    def __init__(self, boot_ns: int) -> None:
        """Watch over the room that was opened at `boot_ns`; after a restart, an episode of this number is another."""
        self._boot_ns = boot_ns
        self._number = 0
        self._unkept: deque[tuple[int, float]] = deque()  # tick and when it was told, the oldest first
        self._recorder = ""
        self._is_gone = False
        self._objects = False

    def told(self, number: int, tick: int, now_s: float) -> None:
        """Take note of a state of episode `number`; 0: of none, so nothing is to be kept."""
        if number != self._number:
            self._number = number
            self._unkept.clear()
        if number:
            self._unkept.append((tick, now_s))

    def reported(self, report: RecordingReport) -> None:
        """Take note of what a recorder has kept; what it says of another episode means nothing."""
        if (report.boot, report.episode) != (self._boot_ns, self._number):
            return
        self._recorder, self._is_gone = report.recorder, False
        while self._unkept and self._unkept[0][0] <= report.last_tick:
            self._unkept.popleft()

    def gone(self, recorder: str) -> None:
        """Take note that a recorder's process ended; until one reports again, nothing more is kept."""
        self._is_gone |= recorder == self._recorder

    def objection(self, now_s: float) -> str:
        """Say in words that nobody keeps the episode, since when, and whose turn it was; "" while somebody does."""
        if not self._unkept:
            return ""
        if self._is_gone:
            return f"This episode is not being recorded: {self._recorder} is gone."
        since_s = self._unkept_s(now_s)
        if since_s < UNKEPT_AFTER_S:
            return ""
        who = f"{self._recorder} has kept nothing" if self._recorder else "nobody has kept anything"
        return f"This episode is not being recorded: {who} for {since_s:.1f} s."

    def news(self, now_s: float) -> tuple[str, str] | None:
        """Return, once, what people are to be told now: the level of a notice and its text.

        A recorder that is only late shows in the room's status for as long as it is; a notice stays longer.
        """
        objection = self.objection(now_s) if self._is_gone or self._unkept_s(now_s) >= _NOTICE_AFTER_S else ""
        if bool(objection) == self._objects:
            return None
        self._objects = bool(objection)
        if objection:
            return "error", objection
        return ("info", f"{self._recorder} records again.") if self._number else None

    def _unkept_s(self, now_s: float) -> float:
        return now_s - self._unkept[0][1] if self._unkept else 0.0
