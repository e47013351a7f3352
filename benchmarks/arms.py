"""Scripted experts with other arms than Pandas, and other end effectors: successes of fifty seeds, beside Pandas.

    python benchmarks/arms.py            # 50 seeds a row, a quarter of an hour to an hour
    python benchmarks/arms.py 10         # as many seeds as are said

Control, the part of a step that moves the arms, is timed for mixed arms too, beside bare mj_step as in control.py.
"""

from __future__ import annotations

import sys
from functools import partial
from statistics import median

from control import bare_step_ms, milliseconds
from report import Bar, report
from support.recorded import record

from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World

SEEDS = 50
CUBES, TRAY, WIPING = "two_arm_multi_cube_lifting", "two_arm_drink_tray_lifting", "three_arm_lift_wiping"
PANDA, UR5E, GEN3 = "panda", "ur5e", "gen3"
SECOND_GRIPPER, PAD = "robotiq_2f85", "wiping_pad"
_PAIRS = (
    (PANDA, UR5E),
    (UR5E, UR5E),
    (GEN3, GEN3),
    (f"{PANDA}+{SECOND_GRIPPER}",) * 2,
    (f"{UR5E}+{SECOND_GRIPPER}",) * 2,
)
_WIPERS = ((PANDA, PANDA, f"{PANDA}+{PAD}"), (UR5E, UR5E, f"{UR5E}+{PAD}"))
ROWS = {CUBES: _PAIRS, TRAY: _PAIRS, WIPING: _WIPERS}
TIMED = (("panda", "ur5e"), ("ur5e", "gen3"))
_ROUNDS = 5


def main() -> None:
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else SEEDS
    metrics: dict[str, float] = {"seeds": seeds}
    bars: list[Bar] = []
    peer: dict[str, float | str] = {"name": "Pandas"}
    for task, rows in ROWS.items():
        pandas = (PANDA,) * len(rows[0])
        for kinds in (pandas, *rows):
            successes, time_s = attempts(task, kinds, seeds)
            name = f"{task}_{'_'.join(kinds)}"
            figures = {f"{name}_success": successes / seeds, f"{name}_time_s": time_s}
            print(f"{name}: {successes} of {seeds}, {time_s:.1f} s", flush=True)
            if kinds == pandas:
                peer |= figures
                continue
            metrics |= figures
            bars.append(Bar.at_least(f"{task}, {' and '.join(kinds)}: successes", successes / seeds, 0.95))
    peer["control_over_bare"] = control_over_bare(World.build(CUBES))
    for kinds in TIMED:
        over_bare = control_over_bare(World.build(CUBES, kinds=kinds))
        metrics[f"control_over_bare_{'_'.join(kinds)}"] = over_bare
        bars.append(Bar.at_most(f"control of {' and '.join(kinds)}, times bare mj_step", over_bare, 1.10))
    report("arms", metrics, peer=peer, bars=bars)


def attempts(task: str, kinds: tuple[str, ...], seeds: int) -> tuple[int, float]:
    """How many of the seeds succeed within a trial, and the median time of those, simulated seconds."""
    world = World.build(task, kinds=kinds)
    limit_s = world.task.trial_limit_s
    times_s = [world.sim_time_s for seed in range(seeds) if run_experts(world, seed, until_s=limit_s).success]
    return len(times_s), median(times_s) if times_s else 0.0


def control_over_bare(world: World) -> float:
    """A control period with the arms driven, over the same physics alone: median of rounds over an episode."""
    episode = record(world, seed=0)
    ratios = []
    for _ in range(_ROUNDS):
        driven = bare = 0.0
        for tick in range(len(episode)):
            for way in (tick % 2, 1 - tick % 2):  # in turns, so that neither always finds the caches warm
                world.set_integration_state(episode.states[tick].tobytes())
                if way:
                    driven += milliseconds(partial(world.drive, episode.actions[tick]))
                else:
                    world.data.ctrl[:] = episode.controls[tick]
                    bare += bare_step_ms(world)
        ratios.append(driven / bare)
    return median(ratios)


if __name__ == "__main__":
    main()
