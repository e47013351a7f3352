"""Tell whether the picture that a person drives by stands still. Pure: ticks and `now_s` in.

The page reports the ticks that it displays; a tick of the world that is not displayed is news that the person lacks.
Until a page has reported any (some browsers keep pixels from scripts), what was drawn for it counts instead.
"""

from __future__ import annotations

STILL_AFTER_S = 1.0


class PictureWatch:
    """Watch one holder's picture. A seat that no page ever looked at needs none: emulated phones drive so."""

    def __init__(self) -> None:
        self._watched = False
        self._reports = False
        self._newest = self._displayed = 0
        self._lacks_since_s: float | None = None  # news, or anything newer than what was displayed last

    def page_came(self) -> None:
        """Take that the holder's page looks at the picture, now or soon."""
        self._watched = True

    def on_state(self, tick: int, now_s: float) -> None:
        """Take the newest tick of the world; a smaller one than before is of another run of the sim."""
        if tick < self._newest:
            self._displayed, self._lacks_since_s = 0, None
        self._newest = tick
        if tick > self._displayed and self._lacks_since_s is None:
            self._lacks_since_s = now_s

    def on_drawn(self, tick: int, now_s: float) -> None:
        """Take that a picture of this tick is on its way to the page."""
        if not self._reports:
            self._display(tick, now_s)

    def on_displayed(self, tick: int, now_s: float) -> None:
        """Take that the page has displayed this tick."""
        self._reports = True
        self._display(tick, now_s)

    def stands_still(self, now_s: float) -> bool:
        """Tell whether the world has gone on for STILL_AFTER_S without anything newer being displayed."""
        since_s = self._lacks_since_s
        return self._watched and since_s is not None and now_s - since_s > STILL_AFTER_S

    def _display(self, tick: int, now_s: float) -> None:
        if self._displayed < tick <= self._newest:
            self._displayed = tick
            self._lacks_since_s = now_s if tick < self._newest else None
