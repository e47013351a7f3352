"""Build the practice course: for each arm a ball to reach, a bar to turn along, a cube and a dish; a plank for two."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from mart.protocol.tasks import Arm, Task
from mart.protocol.tasks.practice_course import OWN_STATIONS, PLANK_GOAL_M, TOGETHER
from mart.sim.scene.data import Array, Data, Flags, length
from mart.sim.scene.scene import Scene, SubtaskScore, TaskStatus
from mart.sim.scene.things import Thing, Tool
from mart.sim.tasks.course_things import (
    BALL_AT_M,
    BAR_AT_M,
    CUBE_AT_M,
    CUBE_HALF_M,
    DISH_AT_M,
    PLANK_AT_M,
    PLANK_HALF_M,
    add_cube,
    add_dish,
    add_marks,
    add_plank,
)
from mart.sim.tasks.stations import StationScores, memory_size

_HIDDEN_Z_M = -0.02  # inside the table top

# How far from its place a thing begins, and how far a bar is turned.
_SPREAD_M, _TURN_RAD = 0.03, (0.5, 0.9)
_PLANK_SPREAD_M = 0.02

# When a try begins and ends, and when a station is done.
_NEAR_M, _AWAY_M = 0.06, 0.10
_REACHED_M, _TURNED_M, _ALONG = 0.03, 0.04, 0.21  # the last: sine of the angle from the bar, 12 degrees
_CLOSED_WIDTH_M, _OPEN_WIDTH_M, _AT_CUBE_M = 0.055, 0.070, 0.05
_LIFTED_M, _DOWN_M = 0.02, 0.005  # of the cube over where it rests
_IN_DISH_M, _LET_GO_M = 0.045, 0.06
_PLANK_LIFTED_M, _PLANK_DOWN_M, _PLANK_THERE_M = 0.03, 0.01, (0.07, 0.04, 0.05)
FALLEN_Z_M = -0.05


class PracticeCourse(Scene):
    """Define the scene of the practice course."""

    def __init__(self, task: Task) -> None:
        super().__init__(task)
        self.memory_size = memory_size(len(task.subtasks))

    def add_objects(self, spec: mujoco.MjSpec) -> None:
        for arm in self.task.arms:
            add_marks(spec, arm)
            add_cube(spec, arm)
            add_dish(spec, arm)
        if self._with_plank:
            add_plank(spec, self.task.arms)

    def attach(self, data: Data) -> None:
        self._data = data
        self._lanes = [_Lane(data, arm) for arm in self.task.arms]
        self._plank = _Plank(data, self.task.arms) if self._with_plank else None
        self._scores = StationScores(self.memory(data), _before(len(self.task.arms)))

    def place_objects(self, random: np.random.Generator) -> None:
        for lane in self._lanes:
            lane.place(random)
        if self._plank is not None:
            self._plank.place(random)

    def observe(self) -> dict[str, Array]:
        seen = {} if self._plank is None else self._plank.observations()
        done = self._scores.done
        for index, lane in enumerate(self._lanes):
            first = index * len(OWN_STATIONS)
            own_done = done[..., first : first + len(OWN_STATIONS)]
            seen |= lane.observations()
            seen[f"stations{index}/done"] = own_done.astype(np.float64)
        return seen

    def remember(self) -> None:
        parts = [lane.stations() for lane in self._lanes]
        if self._plank is not None:
            parts.append(self._plank.stations())
        begun, left, fulfilled = (
            np.stack([flag for part in parts for flag in part[which]], axis=-1) for which in range(3)
        )
        self._scores.see(self._data.time, begun, left, fulfilled)
        done = self._scores.done
        for index, lane in enumerate(self._lanes):
            lane.hide(done[..., index * len(OWN_STATIONS) : (index + 1) * len(OWN_STATIONS)])

    def task_status(self) -> TaskStatus:
        done = self._scores.done
        names = [subtask.name for subtask in self.task.subtasks]
        failed = {
            f"The {arm.color_name} cube fell off the table.": lane.cube.position[..., 2] < FALLEN_Z_M
            for arm, lane in zip(self.task.arms, self._lanes, strict=True)
        }
        if self._plank is not None:
            failed["The plank fell off the table."] = self._plank.plank.position[..., 2] < FALLEN_Z_M
        scores = {
            name: SubtaskScore(self._scores.seconds[..., index], self._scores.tries[..., index])
            for index, name in enumerate(names)
        }
        return TaskStatus(
            {name: done[..., index] for index, name in enumerate(names)},
            np.logical_and.reduce(done, axis=-1),
            failed,
            scores,
        )

    @property
    def _with_plank(self) -> bool:
        return any(subtask.name == TOGETHER for subtask in self.task.subtasks)


SCENE = PracticeCourse


def _before(arms: int) -> list[list[int]]:
    """Return for each station which ones come before: an arm's own one after another, the common one last."""
    own = len(OWN_STATIONS)
    before = [[arm * own + index - 1] if index else [] for arm in range(arms) for index in range(own)]
    return [*before, [arm * own + own - 1 for arm in range(arms)]] if arms > 1 else before


Stations = tuple[
    list[Flags], list[Flags], list[Flags]
]  # where tries begin, where they end, what is fulfilled


class _Lane:
    """View one arm's own stations."""

    def __init__(self, data: Data, arm: Arm) -> None:
        self._arm = arm
        number = arm.name.removeprefix("arm")
        self.cube = Thing(data, f"cube{number}")
        self._ball, self._bar = Thing(data, f"ball{number}"), Thing(data, f"bar{number}")
        self._dish = Thing(data, f"dish{number}")
        self._tool = Tool(data, arm)
        turn = data.site(f"{arm.name}/tool").xmat
        self._tool_rotation = turn.reshape(*turn.shape[:-1], 3, 3)
        mocaps = [int(data.model.body(thing.name).mocapid[0]) for thing in (self._ball, self._bar)]
        self._mark_heights = [data.mocap_pos[..., mocap, 2] for mocap in mocaps]

    def place(self, random: np.random.Generator) -> None:
        """Put the things where an episode begins."""
        ways = np.pad(random.uniform(-_SPREAD_M, _SPREAD_M, (4, 2)), ((0, 0), (0, 1)))
        turn = random.uniform(*_TURN_RAD) * (1 if random.random() < 0.5 else -1)
        yaws = (0.0, turn, random.uniform(-np.pi / 4, np.pi / 4), 0.0)
        places = (BALL_AT_M, BAR_AT_M, (*CUBE_AT_M, CUBE_HALF_M), (*DISH_AT_M, 0.0))
        base = self._arm.pose_base_in_world
        facing = 2 * np.arctan2(base.quaternion_wxyz[3], base.quaternion_wxyz[0])
        for thing, place, way, yaw in zip(
            (self._ball, self._bar, self.cube, self._dish), places, ways, yaws, strict=True
        ):
            thing.put(base.transform_points(np.asarray(place) + way).tolist(), facing + yaw)

    def observations(self) -> dict[str, Array]:
        """Return what the arm's operator sees of its stations."""
        ball, dish = self._ball, self._dish
        return {
            f"{ball.name}/position_in_world": ball.position,
            **self._bar.observations(),
            **self.cube.observations(),
            f"{dish.name}/position_in_world": dish.position,
        }

    def hide(self, done: Flags) -> None:
        """Move the marks of stations that are done out of sight; done: shape (..., own stations)."""
        for index, height in enumerate(self._mark_heights):
            height[...] = np.where(done[..., index], _HIDDEN_Z_M, height)

    def stations(self) -> Stations:
        """Return how each station stands."""
        to_ball, to_bar = self._apart_m(self._ball), self._apart_m(self._bar)
        to_cube, width = self._apart_m(self.cube), self._tool.width_m
        fingers, bar = self._tool_rotation[..., :, 1], self._bar.rotation[..., :, 0]
        along = np.abs(np.add.reduce(fingers * bar, axis=-1)) < _ALONG
        over_m = self.cube.position[..., 2] - CUBE_HALF_M
        to_dish = length((self.cube.position - self._dish.position)[..., :2])
        at_cube = to_cube < _AT_CUBE_M
        begun = [
            to_ball < _NEAR_M,
            to_bar < _NEAR_M,
            at_cube & (width < _CLOSED_WIDTH_M),
            over_m > _LIFTED_M,
        ]
        left = [to_ball > _AWAY_M, to_bar > _AWAY_M, width > _OPEN_WIDTH_M, over_m < _DOWN_M]
        fulfilled = [
            to_ball < _REACHED_M,
            (to_bar < _TURNED_M) & along,
            at_cube & (over_m > _LIFTED_M),
            (to_dish < _IN_DISH_M) & (over_m < _LIFTED_M) & (to_cube > _LET_GO_M),
        ]
        return begun, left, fulfilled

    def _apart_m(self, thing: Thing) -> Array:
        return length(self._tool.position - thing.position)


class _Plank:
    """View the plank that two arms carry."""

    def __init__(self, data: Data, arms: Sequence[Arm]) -> None:
        self.plank = Thing(data, "plank")
        numbers = [arm.name.removeprefix("arm") for arm in arms]
        self._seen = {
            f"handle{number}/position_in_world": data.site(f"handle{number}").xpos for number in numbers
        } | {f"{arm.name}/tool_position_in_world": data.site(f"{arm.name}/tool").xpos for arm in arms}
        self._handles = [data.site(f"handle{number}").xpos for number in numbers]
        self._tools = [data.site(f"{arm.name}/tool").xpos for arm in arms]

    def place(self, random: np.random.Generator) -> None:
        """Put it where an episode begins."""
        x, y = PLANK_AT_M + random.uniform(-_PLANK_SPREAD_M, _PLANK_SPREAD_M, 2)
        self.plank.put((x, y, PLANK_HALF_M[2]))

    def observations(self) -> dict[str, Array]:
        """Return what both see of it."""
        return {"plank/position_in_world": self.plank.position, **self._seen}

    def stations(self) -> Stations:
        """Return how the common station stands."""
        held = [
            length(handle - tool) < _AT_CUBE_M
            for handle, tool in zip(self._handles, self._tools, strict=True)
        ]
        both = np.logical_and.reduce(held)
        over_m = self.plank.position[..., 2] - PLANK_HALF_M[2]
        off_m = np.abs(self.plank.position - np.array(PLANK_GOAL_M))
        there = np.logical_and.reduce(off_m < _PLANK_THERE_M, axis=-1)
        return [both & (over_m > _PLANK_LIFTED_M)], [over_m < _PLANK_DOWN_M], [both & there]
