"""Tell what happened in an episode over time: who drove, what was done, for whom the world waited. Pure.

States are taken one by one and not kept, so that a long episode costs little; what is told is bounded.
"""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections.abc import Iterable, Iterator

from mart.episodes.hand_faults import HandFaults
from mart.protocol.messages import (
    ArmState,
    CatalogueReply,
    Event,
    Lane,
    Span,
    State,
    Trace,
    cue_word,
    operator_word,
)
from mart.protocol.tasks import gripper_observation
from mart.protocol.vocabulary import OperatorKind
from mart.recorder.catalogue.edit_messages import tick_times

MAX_POINTS = 500
MAX_SPANS = 2000  # of a lane; what comes later is not told
WAITED_S = 0.25  # what people are told of as it happens: a stall
_MAX_ARMS = 16
_MAX_SUBTASKS = 64
_MAX_TEXT_CHARACTERS = 500


def timeline(
    states: Iterable[State], events: Iterable[Event], faults: HandFaults, control_hz: float | None = None
) -> CatalogueReply.Details:
    """Return `wall_s`, `lanes` and `traces`.

    Seconds are since the first state: simulated ones where `control_hz` is given, else the wall's.
    """
    told: _Timeline | None = None
    for state in states:
        told = told or _Timeline(state, control_hz)
        told.add(state)
    if told is None:
        return CatalogueReply.Details()
    return CatalogueReply.Details(
        wall_s=told.now_s,
        lanes=[*told.lanes(), *told.lost(faults), *_said(events, told)],
        traces=told.traces(),
        simulated=control_hz is not None,
        tick_times=tick_times(told.seconds),
    )


def runs(seconds: Iterable[float], values: Iterable[str]) -> list[Span]:
    """Return where a value stays the same; each run ends where the next begins. An empty value is no run."""
    found = _Runs()
    for now_s, value in zip(seconds, values, strict=True):
        found.add(now_s, value)
    return found.spans


def second_of(state: State, first_tick: int, start_ns: int, control_hz: float | None) -> float:
    """Return when a state was, since the first one: simulated where `control_hz` is given, else on the wall's clock."""
    if control_hz is not None:
        return (state.tick - first_tick) / control_hz
    return (state.stamps.stepped_ns - start_ns) / 1e9


class _Runs:
    """Gather where a value stays the same."""

    def __init__(self) -> None:
        self.spans: list[Span] = []
        self._value = ""

    def add(self, now_s: float, value: str) -> None:
        if self._value and self.spans:
            self.spans[-1].end_s = now_s
        if value != self._value and value and len(self.spans) < MAX_SPANS:
            self.spans.append(Span(begin_s=now_s, end_s=now_s, text=value))
        self._value = value if len(self.spans) < MAX_SPANS else ""


class _Arm:
    """Gather who drove one arm, from the tick of their first command on, and where they moved it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.driver, self.engaged = _Runs(), _Runs()
        self.height_m, self.gripper = array("d"), array("d")
        self._begin_s: float | None = None
        self._first = ""

    def add(self, now_s: float, arm: ArmState) -> None:
        source = _driver(arm)
        if not self.height_m:  # the first state has had no command yet
            self._begin_s, self._first = now_s, source
        else:
            self.begin(source)
            self.driver.add(now_s, source)
        self.engaged.add(now_s, "engaged" if arm.fresh and arm.engaged else "")
        self.height_m.append(_finite(arm.tool_in_base.z))
        self.gripper.append(_finite(arm.gripper))

    def begin(self, source: str = "") -> None:
        """Let the first tick be whose the second is; whose it is itself where there is no second."""
        if self._begin_s is not None:
            self.driver.add(self._begin_s, source or self._first)
            self._begin_s = None


def _driver(arm: ArmState) -> str:
    """Return who drove in this tick; nothing for a kind of operator that this version does not know."""
    try:
        return operator_word(arm.source) if arm.fresh else OperatorKind.HOLD.value
    except ValueError:
        return ""


def _finite(number: float) -> float:
    return number if math.isfinite(number) else 0.0


def _fingerless(state: State) -> set[str]:
    """Return the arms of which the joints are observed and no gripper is: they have no fingers."""
    seen = {observation.name for observation in state.observations}
    return {
        one.arm
        for one in state.arms
        if f"{one.arm}/joint_positions" in seen and gripper_observation(one.arm) not in seen
    }


class _Timeline:
    """Gather one episode, state by state."""

    def __init__(self, first: State, control_hz: float | None) -> None:
        self.now_s = 0.0
        self._start_ns, self._first_tick = first.stamps.stepped_ns, first.tick
        self._control_hz = control_hz
        self._stepped_ns = array("Q")
        self.seconds = array("d")
        self._subtasks = {one.name: _Runs() for one in first.progress.subtasks[:_MAX_SUBTASKS]}
        self._arms = {one.arm: _Arm(one.arm) for one in first.arms[:_MAX_ARMS]}
        self._fingerless = _fingerless(first)
        self._waiting: dict[str, list[Span]] = {}

    def add(self, state: State) -> None:
        now_s = self.now_s = self._second(state)
        self.seconds.append(now_s)
        self._stepped_ns.append(state.stamps.stepped_ns)
        done = {one.name for one in state.progress.subtasks if one.done}
        for name, found in self._subtasks.items():
            found.add(now_s, "done" if name in done else "")
        seen = {one.arm: one for one in state.arms}
        for name, arm in self._arms.items():
            arm.add(now_s, seen.get(name) or ArmState())
        if state.straggler in self._arms and state.straggler_late_s >= WAITED_S:
            begin_s = max(0.0, now_s - state.straggler_late_s)
            spans = self._waiting.setdefault(state.straggler, [])
            if len(spans) < MAX_SPANS:
                spans.append(Span(begin_s=begin_s, end_s=now_s))

    def _second(self, state: State) -> float:
        return second_of(state, self._first_tick, self._start_ns, self._control_hz)

    def second_of(self, wall_ns: int) -> float:
        """Return when something was said; negative for what was said before."""
        if self._control_hz is None or wall_ns < self._start_ns:
            return (wall_ns - self._start_ns) / 1e9
        return self.seconds[max(0, bisect_right(self._stepped_ns, wall_ns) - 1)]

    def lanes(self) -> Iterator[Lane]:
        for name, done in self._subtasks.items():
            yield Lane(kind="subtask", name=name, spans=done.spans)
        for arm in self._arms.values():
            arm.begin()
            yield Lane(kind="driver", name=arm.name, spans=arm.driver.spans)
            yield Lane(kind="engaged", name=arm.name, spans=arm.engaged.spans)
        for name, spans in self._waiting.items():
            yield Lane(kind="waiting", name=name, spans=spans)

    def lost(self, faults: HandFaults) -> Iterator[Lane]:
        arms = list(self._arms)
        lost = faults.transitions(arms, self._first_tick, len(self.seconds))
        for column, name in enumerate(arms):
            if lost[:, column].any():
                spans = runs(self.seconds, ("lost" if one else "" for one in lost[:, column]))
                yield Lane(kind="lost", name=name, spans=spans)

    def traces(self) -> Iterator[Trace]:
        every = -(-len(self.seconds) // MAX_POINTS)
        at_s = self.seconds[::every]
        for arm in self._arms.values():
            yield Trace(arm=arm.name, quantity="height", unit="m", seconds=at_s, values=arm.height_m[::every])
            if arm.name not in self._fingerless:
                yield Trace(
                    arm=arm.name, quantity="gripper", unit="", seconds=at_s, values=arm.gripper[::every]
                )


def _said(events: Iterable[Event], told: _Timeline) -> Iterator[Lane]:
    """Tell what partners said to each other, and what the services said."""
    said: dict[tuple[str, str], list[Span]] = {}
    for event in events:
        match event.WhichOneof("what"):
            case "cue_given":
                lane, text = ("cue", event.cue_given.arm), cue_word(event.cue_given.cue)
            case "notice":
                lane, text = ("notice", ""), event.notice.text[:_MAX_TEXT_CHARACTERS]
            case _:
                continue
        at_s = told.second_of(event.wall_ns)
        spans = said.setdefault(lane, []) if lane in said or len(said) < _MAX_ARMS else []
        if at_s >= 0.0 and len(spans) < MAX_SPANS:
            spans.append(Span(begin_s=at_s, end_s=at_s, text=text))
    for kind, name in sorted(said):
        if said[kind, name]:
            yield Lane(kind=kind, name=name, spans=said[kind, name])
