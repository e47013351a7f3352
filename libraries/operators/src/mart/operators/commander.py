"""Turn the states of a room into an operator's commands. Pure: states in, commands out.

An operator acts once for every state, or, with a control rate of its own in a faster room, for every second, third, …
one: its target holds in between, so the arm goes as in a room of its rate (docs/decisions/0059). Its target is
absolute, so a command that is lost, repeated or overtaken does no harm: while no new state comes, the same command is
given again under growing numbers, and the barrier hears that the operator is still there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import SupportsFloat

import numpy as np

from mart.operators.operator import Array, Operator, SeatView, ToolTarget
from mart.protocol.errors import Corrupt, InvalidInput, MartError
from mart.protocol.messages import (
    ArmState,
    Command,
    CommandStamps,
    Cue,
    PoseMessage,
    State,
    pose_from_message,
    pose_message,
)
from mart.protocol.messages import Operator as OperatorOnWire
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task


class SeatCommander:
    """Give commands for the seats that one operator holds in one room.

    An operator of several arms of which people hold some goes on with the others: it acts for all and commands its own.
    It remembers as long as it keeps one of its seats and the world is not reset.
    """

    def __init__(
        self,
        operator: Operator,
        task: Task,
        arms: Sequence[str],
        source: OperatorOnWire,
        needs: Iterable[str] | None = None,
        *,
        act_every_ticks: int = 1,
    ) -> None:
        """Command for an operator. `needs` names the observations to show; None: those shown to these arms.

        act_every_ticks: of the room; see `mart.protocol.control_rate.ticks_for_each`.
        """
        self.arms = tuple(arms)
        self._operator, self._task, self._source = operator, task, source
        self._shapes = _shapes(task, self.arms, needs)
        self._epochs: Mapping[str, int] = {}
        self._sequences = dict.fromkeys(self.arms, 0)
        self._targets: dict[str, tuple[PoseMessage, float, bool]] = {}
        self._newest = (0, 0, 0.0)  # boot, tick, simulated seconds
        self._begun = False
        self._act_every_ticks = act_every_ticks
        self._begun_tick = self._acted_tick = 0

    def seat(self, epochs: Mapping[str, int]) -> None:
        """Tell the epochs of the seats that the operator holds now, by arm."""
        held = {arm: epochs[arm] for arm in self.arms if arm in epochs}
        kept = any(self._epochs.get(arm) == epoch for arm, epoch in held.items())
        self._begun = self._begun and kept
        self._epochs = held

    def observe(self, state: State) -> bool:
        """Let the operator act on `state` where it is its turn; False where the state was no news.

        Raises Corrupt where the state lacks what the operator should see, and InvalidInput where what the operator says
        is no target, or where it fails in any other way.
        """
        newest = (state.boot, state.tick, state.sim_time_s)
        if not self._epochs or newest[:2] == self._newest[:2]:
            return False
        arms = {arm.arm: arm for arm in state.arms}
        missing = [arm for arm in self.arms if arm not in arms]
        if missing:
            raise Corrupt(f"A state without {', '.join(missing)} came, which is driven here.")
        begins = not self._begun or self._world_was_reset(state, arms[self.arms[0]])
        self._newest = newest
        if begins or self._is_its_turn(state.tick):
            self._act(state, arms, begins=begins)
        for arm in self.arms:  # whoever drove under this epoch before has counted so far
            self._sequences[arm] = max(self._sequences[arm], arms[arm].sequence)
        return True

    def hear(self, cue: Cue, arm: str, tick: int) -> None:
        """Let the operator hear a person's word, said by who drives `arm` when the newest state was that of `tick`.

        A word from before the operator began, or from its own seat, is none to it. Raises as `observe` where it fails.
        """
        if self._begun and tick >= self._begun_tick and arm not in self._epochs:
            _guarded(lambda: self._operator.on_cue(cue, arm))

    def _act(self, state: State, arms: Mapping[str, ArmState], *, begins: bool) -> None:
        view = self._view(state, arms)
        if begins:
            _guarded(lambda: self._operator.begin(state.episode))
            self._begun, self._begun_tick = True, state.tick
        self._acted_tick = state.tick
        for arm, target in _targets_of(self._operator, view).items():
            self._targets[arm] = pose_message(target.pose_tool_in_base), target.gripper, target.engaged

    def _is_its_turn(self, tick: int) -> bool:
        """Whether a tick of its own has begun since it acted: they count from its beginning, whatever is missed."""
        return self._own_tick(tick) > self._own_tick(self._acted_tick)

    def _own_tick(self, tick: int) -> int:
        return (tick - self._begun_tick) // self._act_every_ticks

    def commands(self, wall_ns: int) -> list[Command]:
        """Return what the operator wants now, one command a seat, under new numbers; none before it saw a state."""
        wanted = self._epochs.keys() & self._targets.keys() if self._begun else ()
        return [self._command(arm, wall_ns) for arm in sorted(wanted)]

    def _view(self, state: State, arms: Mapping[str, ArmState]) -> SeatView:
        return SeatView(
            task=self._task,
            episode=state.episode,
            tick=state.tick,
            sim_time_s=state.sim_time_s,
            observations=_observations(state, self._shapes),
            poses_tool_in_base={arm: pose_from_message(arms[arm].tool_in_base) for arm in self.arms},
            integration_state=state.integration_state,
        )

    def _world_was_reset(self, state: State, first: ArmState) -> bool:
        boot, _, sim_time_s = self._newest
        return not first.action or state.boot != boot or state.sim_time_s < sim_time_s

    def _command(self, arm: str, wall_ns: int) -> Command:
        target, gripper, engaged = self._targets[arm]
        self._sequences[arm] += 1
        return Command(
            arm=arm,
            seat_epoch=self._epochs[arm],
            sequence=self._sequences[arm],
            target_tool_in_base=target,
            gripper=gripper,
            engaged=engaged,
            source=self._source,
            stamps=CommandStamps(sent_ns=wall_ns),
            seen_tick=self._newest[1],
            state_tick=self._acted_tick,
        )


def _shapes(task: Task, arms: Iterable[str], needs: Iterable[str] | None) -> dict[str, tuple[int, ...]]:
    if needs is None:
        return {one.name: one.shape for arm in arms for one in task.observations_of(arm)}
    known = {one.name: one.shape for one in task.observations}
    return {name: known[name] for name in needs if name in known}


def _observations(state: State, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, Array]:
    values = {observation.name: observation.value for observation in state.observations}
    try:
        return {
            name: np.array(values[name], dtype=np.float64).reshape(shape) for name, shape in shapes.items()
        }
    except (KeyError, ValueError) as error:
        raise Corrupt(f"A state came without what an operator should see: {error}.") from error


def _guarded(call: Callable[[], object]) -> object:
    """Call an operator, which may be anybody's code: whatever it raises becomes a sentence."""
    try:
        return call()
    except MartError:
        raise
    except Exception as error:
        raise InvalidInput(f"The operator failed: {type(error).__name__}: {error}") from error


def _targets_of(operator: Operator, view: SeatView) -> dict[str, ToolTarget]:
    """The operator's targets, checked: it may be anybody's code."""
    said = _guarded(lambda: operator.act(view))
    if not isinstance(said, Mapping):
        raise InvalidInput(
            f"The operator gave {type(said).__name__}; give a dictionary from arm to ToolTarget."
        )
    return {arm: _checked(arm, said.get(arm)) for arm in view.poses_tool_in_base}


def _checked(arm: str, target: object) -> ToolTarget:
    if not isinstance(target, ToolTarget) or not isinstance(target.pose_tool_in_base, Pose):
        raise InvalidInput(
            f"The operator gave {type(target).__name__} for {arm}; give a ToolTarget with a Pose."
        )
    gripper: object = target.gripper  # whatever the annotation says, it is anybody's code that filled it
    if not (isinstance(gripper, SupportsFloat) and 0.0 <= float(gripper) <= 1.0):
        raise InvalidInput(f"The operator gave gripper {gripper!r} for {arm}; give 0 (open) to 1 (closed).")
    return ToolTarget(target.pose_tool_in_base, float(gripper), bool(target.engaged))
