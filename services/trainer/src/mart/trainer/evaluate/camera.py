"""Keeps episodes of an evaluation to look at: stepped once more with the same actions, which gives the same course."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mart.protocol import clock
from mart.protocol.tasks import Task
from mart.rollouts.client import BatchState, RolloutClient
from mart.trainer.evaluate.footage import Footage, write
from mart.trainer.evaluate.rollouts import Course


@dataclass(frozen=True)
class Camera:
    """Films episodes of one policy. `policy`: its name, for people."""

    client: RolloutClient
    task: Task
    control_hz: float
    policy: str

    def keep(self, courses: Mapping[Path, Course]) -> None:
        """Each as an episode file at its path."""
        if not courses:
            return
        model = self.client.model(self.task.name, self.control_hz, len(self.task.arms))
        looks = self._step_again(list(courses.values()))
        for world, (path, course) in enumerate(courses.items()):
            write(path, self._footage(course, looks, world), model, clock.wall_ns())

    def _step_again(self, courses: Sequence[Course]) -> list[BatchState]:
        """How the worlds stood after each tick; one whose course has ended stands still."""
        seeds = [course.played.seed for course in courses]
        ticks = np.array([len(course.actions) for course in courses])
        arms = len(self.task.arms)
        looks = [self.client.reset(self.task.name, seeds, self.control_hz, arms, integration_states=True)]
        for tick in range(int(ticks.max())):
            actions = [course.actions[min(tick, len(course.actions) - 1)] for course in courses]
            looks.append(self.client.step(np.array(actions), tick < ticks))
        return looks

    def _footage(self, course: Course, looks: Sequence[BatchState], world: int) -> Footage:
        own, played = looks[: len(course.actions) + 1], course.played
        states = (look.integration_states for look in own)
        return Footage(
            task=self.task,
            control_hz=self.control_hz,
            policy=self.policy,
            seed=played.seed,
            outcome="success" if played.outcome == "success" else "failure",
            reason=own[-1].reasons[world] or ("time is up" if played.outcome == "time" else ""),
            integration_states=[
                state[world].astype("<f8").tobytes() for state in states if state is not None
            ],
            observations={
                name: np.array([look.observations[name][world] for look in own])
                for name in own[0].observations
            },
            actions=course.actions,
            subtasks=np.array([look.subtasks[world] for look in own]),
        )
