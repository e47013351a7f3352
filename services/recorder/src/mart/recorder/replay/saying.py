"""Put a replay into words: what will move, before it is confirmed, and how it ended."""

from __future__ import annotations

import math
from typing import Any

from mart.episodes.reader import EpisodeFile
from mart.recorder.replay.to_drivers import Replay, Replayed


def before(replay: Replay, file: EpisodeFile) -> str:
    """Return which arms will move, for how long, from where and how fast."""
    led, episode = replay.led, file.episode
    arms = " and ".join(replay.drivers)
    whole = (
        f"{arms} of {replay.room} will move for about {led.duration_s:.0f} s: {led.approach_s:.0f} s to where episode "
        f"{episode.number} of {episode.room} began, then {led.recorded.duration_s / led.speed:.0f} s along its way at "
        f"{led.speed:g} of its speed."
    )
    lines = [whole, *(f"  {arm}: {_arm(replay, arm)}" for arm in replay.drivers)]
    lines.append("Grippers open and close as they did. Ctrl-C, or Stop on any page, stops the arms.")
    return "\n".join(lines)


def after(replay: Replay, ended: Replayed, file: EpisodeFile) -> tuple[dict[str, Any], str]:
    """Return how it ended, as JSON and in words."""
    total_s = replay.led.duration_s
    told = {
        "path": str(file.path),
        "room": replay.room,
        "arms": [*replay.drivers],
        "speed": replay.led.speed,
        "led_s": round(ended.led_s, 3),
        "of_s": round(total_s, 3),
        "why_ended": ended.why,
    }
    arms = " and ".join(replay.drivers)
    if not ended.why:
        return told, f"{arms} of {replay.room} went the whole way, {total_s:.0f} s."
    stand = "stands" if len(replay.drivers) == 1 else "stand"
    return told, f"{arms} of {replay.room} {stand} after {ended.led_s:.0f} of {total_s:.0f} s: {ended.why}"


def _arm(replay: Replay, arm: str) -> str:
    led = replay.led
    away_m, away_rad = led.apart(arm)
    stands = ", ".join(f"{value:.2f}" for value in led.stands[arm].position)
    way = led.recorded.arms[arm]
    return (
        f"driven by {replay.drivers[arm]}; its tool stands at ({stands}) m in its base, {away_m:.2f} m and "
        f"{math.degrees(away_rad):.0f} degrees from where it began; the way is {way.length_m:.2f} m long, at most "
        f"{led.fastest_m_s(arm):.2f} m/s."
    )
