"""What a bad network does to people who share a world: our barrier, request and reply, and a world that never waits.

Each way of advancing the world meets each network, with two, three and four people, and with people whose networks
differ; scripted people of skill `expert` do the first task. Networks are tools/netrelay's profiles, in simulated time.
Plots for docs/networks.md are drawn beside.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

import numpy as np
from report import Bar, report
from support.network_plots import draw
from support.networked_room import WAYS, NetworkedRoom, RoomFigures

from mart.protocol.tasks import task_names
from mart.sim.world import World
from tools.netrelay.impairment import PROFILES

TASK = "two_arm_multi_cube_lifting"
EPISODES = 3
PEOPLE = (2, 3, 4)
SIM_LIMIT_S, WALL_LIMIT_S = 40.0, 240.0
SAME = ("lan", "wifi", "4g", "intercontinental", "outage")
MIXED = {"mixed": ("wifi", "lan", "4g", "intercontinental")}  # of fewer people the last
OUTAGE_PERIOD_S, OUTAGE_S = 20.0, 2.0
LEAD_S = 1.5  # an episode begins so long before the network goes dark
PICTURE = Path("docs/images/networks.svg")


@dataclass(frozen=True)
class Cell:
    """One way, one network, some people: means and percentiles over all episodes."""

    real_time_factor: float
    success: float
    stale_p50_ms: float
    stale_p95_ms: float
    waiting_percent: tuple[float, ...]  # of the time, by arm
    repeated_percent: float  # commands that moved the world a second time


def main() -> None:
    assert TASK in task_names()
    episodes = int(sys.argv[1]) if len(sys.argv) > 1 else EPISODES
    cells: dict[tuple[str, str, int], Cell] = {}
    back_s: list[float] = []
    told_s: list[float] = []
    for people in PEOPLE:
        world = World.build(TASK, arms=people)
        for network in (*SAME, *MIXED):
            for way in WAYS:
                played = [_play(world, way, network, seed) for seed in range(episodes)]
                cells[way, network, people] = _cell(played, world.arms)
                print(way, network, people, cells[way, network, people], flush=True)
                if (way, network) == ("barrier", "outage"):
                    back_s += [_back_s(figures) for figures in played if figures.ticks_s[-1] > 20.6]
                    told_s += [figures.told_s[0] - 18.0 for figures in played if figures.told_s]
    metrics = _figures(cells, "barrier")
    peer = _figures(cells, "request_reply") | _figures(cells, "hold_last")
    metrics["outage_told_after_s"], metrics["outage_back_after_s"] = max(told_s), max(back_s)
    report("network", metrics, peer, _bars(cells, max(told_s), max(back_s)))
    draw(
        PICTURE,
        {key: (cell.real_time_factor, cell.stale_p50_ms, cell.success) for key, cell in cells.items()},
    )


def _play(world: World, way: str, network: str, seed: int) -> RoomFigures:
    names = MIXED.get(network, (network,) * max(PEOPLE))
    profiles = [PROFILES[name] for name in names[-len(world.arms) :]]
    began_s = OUTAGE_PERIOD_S - OUTAGE_S - LEAD_S if network == "outage" else 0.0
    return NetworkedRoom(world, way, profiles, seed, began_s).play(SIM_LIMIT_S, WALL_LIMIT_S)


def _cell(played: Sequence[RoomFigures], arms: Sequence[str]) -> Cell:
    stale_ms = 1e3 * np.array([one for figures in played for one in figures.stale_s])
    wall_s = sum(figures.wall_s for figures in played)
    return Cell(
        real_time_factor=sum(figures.sim_s for figures in played) / wall_s,
        success=mean(figures.success for figures in played),
        stale_p50_ms=float(np.percentile(stale_ms, 50)),
        stale_p95_ms=float(np.percentile(stale_ms, 95)),
        waiting_percent=tuple(100 * sum(figures.waits_s[arm] for figures in played) / wall_s for arm in arms),
        repeated_percent=100 * sum(figures.repeated for figures in played) / len(stale_ms),
    )


def _back_s(figures: RoomFigures) -> float:
    """From the end of the outage to the tick from which on the world runs at its rate again."""
    after = [at_s for at_s in figures.ticks_s if at_s > OUTAGE_PERIOD_S]
    return after[0] - OUTAGE_PERIOD_S


def _figures(cells: dict[tuple[str, str, int], Cell], wanted: str) -> dict[str, float | str]:
    return {
        f"{way}_{network}_{people}_people_{name}": value
        for (way, network, people), cell in cells.items()
        if way == wanted
        for name, value in (
            ("real_time_factor", cell.real_time_factor),
            ("success", cell.success),
            ("stale_p50_ms", cell.stale_p50_ms),
            ("stale_p95_ms", cell.stale_p95_ms),
            ("repeated_percent", cell.repeated_percent),
            ("waiting_percent_by_arm", ", ".join(f"{share:.2f}" for share in cell.waiting_percent)),
        )
    }


def _bars(cells: dict[tuple[str, str, int], Cell], told_s: float, back_s: float) -> list[Bar]:
    bars = [
        Bar.at_least(f"{network}, {people} people: real-time factor", cell.real_time_factor, 0.98)
        for (way, network, people), cell in cells.items()
        if way == "barrier" and network != "outage"
    ]
    repeated = sum(cell.repeated_percent for (way, _, _), cell in cells.items() if way == "barrier")
    return [
        *bars,
        Bar.at_most("commands that moved the world twice, %", repeated, 0.0),
        Bar.at_most("outage: told after, s", told_s, 0.3),
        Bar.at_most("outage: first tick after its end, s", back_s, 0.5),
    ]


if __name__ == "__main__":
    main()
