"""One person with assistants beside a full crew of people: success, time and waiting on tray, handover and wiping.

People are emulated: scripts of the skill `average` with their errors, tremor and delays. Assistants are scripts of the
skill `expert` that obey cues; the person gives them as late as such a person notices and presses. Every episode is
played twice from the same world, by the full crew of people, who say nothing, and by one of them with assistants; the
person sits at another arm each time. A hand waits while its tool is where it was a second before, within 2 cm. Time is
simulated; an episode ends with success, failure or the time that a trial of the task allows.

`assistants.py 40` plays 40 episodes a cell.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import mean

import numpy as np
from report import Bar, report
from support.emulated_person import EmulatedVoice

from mart.operators import SeatView
from mart.sim.experts import ScriptedOperator, get_skill
from mart.sim.world import World

TASKS = {
    "tray": "two_arm_drink_tray_lifting",
    "handover": "two_arm_pick_place_handover",
    "wiping": "three_arm_lift_wiping",
}
EPISODES = 8
PERSON, ASSISTANT = get_skill("average"), get_skill("expert")
WAITS_WITHIN_M, WAITS_S = 0.02, 1.0


@dataclass(frozen=True)
class Played:
    """An episode: whether it succeeded, its seconds, those in which a person waited (mean over people), the cues."""

    success: bool
    time_s: float
    waiting_s: float
    cues: int
    people: int


def main() -> None:
    episodes = int(sys.argv[1]) if len(sys.argv) > 1 else EPISODES
    metrics: dict[str, float] = {"episodes": episodes}
    peer: dict[str, object] = {"name": "full crew of emulated people"}
    bars: list[Bar] = []
    rows = []
    for name, task in TASKS.items():
        world = World.build(task)
        crew = [play(world, number, None) for number in range(episodes)]
        alone = [play(world, number, world.arms[number % len(world.arms)]) for number in range(episodes)]
        metrics |= figures(name, alone)
        peer |= figures(name, crew)
        rows += [row(name, "full crew", crew), row(name, "one with assistants", alone)]
        bars += [
            Bar.at_least(f"{name}: successes beside the crew's", rate(alone) - rate(crew), -0.25),
            Bar.at_most(
                f"{name}: people's seconds a success beside the crew's", per_success(alone, crew), 1.0
            ),
        ]
    print(*table(rows), sep="\n")
    report("assistants", metrics, peer, bars)


def play(world: World, number: int, person: str | None) -> Played:
    """Play one episode in the world of this number; person: whose arm is a person's, None: all are."""
    world.reset(number)
    people = (person,) if person else world.arms
    operators = {
        arm: ScriptedOperator(world.task, arm, PERSON if arm in people else ASSISTANT, seed=1)
        for arm in world.arms
    }
    for operator in operators.values():
        operator.begin(number)
    voice = EmulatedVoice(world.task, person, PERSON.notice_s) if person else None
    stillness = {arm: Stillness(round(WAITS_S * world.control_hz)) for arm in people}
    limit_s, tick = world.task.trial_limit_s, 0
    progress = world.progress()
    while not (progress.success or progress.failed or world.sim_time_s >= limit_s):
        actions = []
        for arm, operator in operators.items():
            view = view_of(world, arm, number, tick)
            target = operator.act(view)[arm]
            actions.append(world.action_for(arm, target.pose_tool_in_base, target.gripper))
            if arm in stillness:
                stillness[arm].see(view.poses_tool_in_base[arm].position)
            if voice and arm == person:
                cues = voice.due(view, target)
        for cue in cues if voice and person else ():
            for arm in world.arms:
                if arm != person:
                    operators[arm].on_cue(cue, person)
        world.step(actions)
        progress, tick = world.progress(), tick + 1
    waiting_s = mean(still.ticks for still in stillness.values()) / world.control_hz
    return Played(progress.success, world.sim_time_s, waiting_s, voice.count if voice else 0, len(people))


def view_of(world: World, arm: str, episode: int, tick: int) -> SeatView:
    poses = {arm: world.tool_pose_in_base(arm)}
    return SeatView(world.task, episode, tick, world.sim_time_s, world.observations_for(arm), poses)


class Stillness:
    """Count the ticks in which a tool is where it was `ticks` before."""

    def __init__(self, ticks: int) -> None:
        self._places: deque[np.ndarray] = deque(maxlen=ticks)
        self.ticks = 0

    def see(self, position: np.ndarray) -> None:
        full = len(self._places) == self._places.maxlen
        if full and float(np.linalg.norm(position - self._places[0])) < WAITS_WITHIN_M:
            self.ticks += 1
        self._places.append(position)


def rate(played: Sequence[Played]) -> float:
    return mean(one.success for one in played)


def people_s(played: Sequence[Played]) -> float:
    """People's seconds for one success; those of failures count."""
    return sum(one.people * one.time_s for one in played) / max(sum(one.success for one in played), 1)


def per_success(alone: Sequence[Played], crew: Sequence[Played]) -> float:
    return people_s(alone) / people_s(crew)


def figures(name: str, played: Sequence[Played]) -> dict[str, float]:
    times_s = [one.time_s for one in played if one.success]
    return {
        f"{name}_success": sum(one.success for one in played),
        f"{name}_time_s": mean(times_s) if times_s else float("nan"),
        f"{name}_waiting_s": mean(one.waiting_s for one in played),
        f"{name}_waiting_share": sum(one.waiting_s for one in played) / sum(one.time_s for one in played),
        f"{name}_people_s_a_success": people_s(played),
        f"{name}_cues": mean(one.cues for one in played),
    }


def row(name: str, who: str, played: Sequence[Played]) -> tuple[str, ...]:
    of = figures("", played)
    return (
        name,
        who,
        f"{of['_success']} of {len(played)}",
        f"{of['_time_s']:.1f}",
        f"{of['_waiting_s']:.1f} ({of['_waiting_share']:.0%})",
        f"{of['_people_s_a_success']:.0f}",
        f"{of['_cues']:.1f}",
    )


def table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Lines of Markdown, for the docs."""
    head = (
        "task",
        "who",
        "success",
        "time, s",
        "a person waits, s",
        "people's s a success",
        "cues an episode",
    )
    return [f"| {' | '.join(cells)} |" for cells in (head, ("---",) * len(head), *rows)]


if __name__ == "__main__":
    main()
