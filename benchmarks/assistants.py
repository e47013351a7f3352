"""One person with assistants beside a full crew of people: success, time and waiting on tray, handover and wiping.

People are emulated: scripts of the skill `average` with their errors, tremor and delays. Assistants are scripts of the
skill `expert` that obey cues; the person gives them as late as such a person notices and presses. Every episode is
played three times from the same world: by the full crew, who say nothing, by one of them with assistants, and by that
one who says nothing to them. The person sits at another arm each time. A hand waits while its tool is where it was a
second before, within 2 cm. Time is simulated; an episode ends with success, failure or the time of the task's trial.

`assistants.py 40` plays 40 episodes a cell. The table goes to docs/how-to-run-a-session.md.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

import numpy as np
from report import Bar, report
from support.emulated_person import EmulatedVoice

from mart.operators import SeatView
from mart.protocol.messages import Cue
from mart.sim.experts import ScriptedOperator, get_skill
from mart.sim.world import World

TASKS = {
    "tray": "two_arm_drink_tray_lifting",
    "handover": "two_arm_pick_place_handover",
    "wiping": "three_arm_lift_wiping",
}
EPISODES = 20
PERSON, ASSISTANT = get_skill("average"), get_skill("expert")
PAGE = Path(__file__).parents[1] / "docs/how-to-run-a-session.md"
BEGIN, END = "<!-- assistants: begin -->", "<!-- assistants: end -->"
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
        alone = [play(world, number, seat_of(world, number)) for number in range(episodes)]
        silent = [play(world, number, seat_of(world, number), speaks=False) for number in range(episodes)]
        metrics |= figures(name, alone)
        peer |= figures(name, crew) | figures(f"{name}_silent", silent)
        rows += [
            row(name, "full crew", crew),
            row(name, "one with assistants", alone),
            row(name, "the same, without cues", silent),
        ]
        bars += [
            Bar.at_least(f"{name}: success rate less the crew's", rate(alone) - rate(crew), -0.25),
            Bar.at_most(
                f"{name}: people's seconds a success, times the crew's", people_s(alone) / people_s(crew), 1.0
            ),
        ]
    write_table(rows, episodes)
    report("assistants", metrics, peer, bars)


def seat_of(world: World, number: int) -> str:
    """Return the person's arm in the episode of this number."""
    return world.arms[number % len(world.arms)]


def play(world: World, number: int, person: str | None, *, speaks: bool = True) -> Played:
    """Play one episode in the world of this number; person: whose arm is a person's, None: all are."""
    world.reset(number)
    people = (person,) if person else world.arms
    operators = {
        arm: ScriptedOperator(world.task, arm, PERSON if arm in people else ASSISTANT, seed=1)
        for arm in world.arms
    }
    for operator in operators.values():
        operator.begin(number)
    voice = EmulatedVoice(world.task, person, PERSON.notice_s) if person and speaks else None
    stillness = {arm: Stillness(round(WAITS_S * world.control_hz)) for arm in people}
    progress, tick = world.progress(), 0
    while not (progress.success or progress.failed or world.sim_time_s >= world.task.trial_limit_s):
        views = {arm: view_of(world, arm, number, tick) for arm in world.arms}
        targets = {arm: operators[arm].act(view)[arm] for arm, view in views.items()}
        for arm, still in stillness.items():
            still.see(views[arm].poses_tool_in_base[arm].position)
        if voice and person:
            tell(operators, person, voice.due(views[person], targets[person]))
        world.step(
            [
                world.action_for(arm, target.pose_tool_in_base, target.gripper)
                for arm, target in targets.items()
            ]
        )
        progress, tick = world.progress(), tick + 1
    waiting_s = mean(still.ticks for still in stillness.values()) / world.control_hz
    return Played(progress.success, world.sim_time_s, waiting_s, voice.count if voice else 0, len(people))


def tell(operators: Mapping[str, ScriptedOperator], person: str, cues: Sequence[Cue]) -> None:
    """Give the person's cues to every other arm."""
    for cue in cues:
        for arm in operators.keys() - {person}:
            operators[arm].on_cue(cue, person)


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
        f"{of['_waiting_s']:.1f} ({100 * of['_waiting_share']:.0f} %)",
        f"{of['_people_s_a_success']:.0f}",
        f"{of['_cues']:.1f}",
    )


def write_table(rows: Sequence[tuple[str, ...]], episodes: int) -> None:
    """Write a Markdown table into the page, between its marks."""
    head = (
        "task",
        "who",
        "success",
        "time, s",
        "a person waits, s",
        "people's s a success",
        "cues an episode",
    )
    lines = [f"| {' | '.join(cells)} |" for cells in (head, ("---",) * len(head), *rows)]
    caption = f"{episodes} episodes a row, simulated seconds; time is that of successes:"
    before, begin, rest = PAGE.read_text().partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise SystemExit(f"{PAGE} lacks {BEGIN} or {END}; put them where the table belongs.")
    PAGE.write_text("\n".join([before + begin, "", caption, "", *lines, "", end + after]))
    print(*lines, sep="\n")


if __name__ == "__main__":
    main()
