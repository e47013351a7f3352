"""An episode of a policy as an episode file: what `mart episodes show` and `mart episodes render` read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mart.episodes.mcap_entries import McapEntry
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.messages import (
    OPERATOR_POLICY,
    ArmState,
    Model,
    Observation,
    PoseMessage,
    Progress,
    State,
    Subtask,
    TickStamps,
)
from mart.protocol.recording import (
    STATE,
    CadenceRecord,
    EpisodeRecord,
    OperatorsRecord,
    RoomRecord,
    Shift,
    VerificationRecord,
)
from mart.protocol.tasks import Task, gripper_observation
from mart.protocol.vocabulary import EpisodeOutcome, OperatorKind, Verdict

Array = NDArray[np.float64]

ROOM = "evaluation"
_NUMBER = 1


@dataclass(frozen=True)
class RolloutEpisode:
    """One world over an episode of T ticks.

    integration_states: T + 1 of them. observations: by name, float64[T + 1, *shape]. actions: float64[T, arms, 7].
    subtasks: bool[T + 1, S] in the catalogue's order.
    """

    task: Task
    control_hz: float
    policy: str  # its name, for people
    seed: int
    outcome: str  # success or failure
    reason: str
    integration_states: Sequence[bytes]
    observations: Mapping[str, Array]
    actions: Array
    subtasks: NDArray[np.bool_]

    @property
    def ticks(self) -> int:
        return len(self.actions)

    def state(self, tick: int, started_ns: int) -> State:
        """Return the state after `tick` ticks. Nobody waited, nothing was late: the stamps are those of real time."""
        at_ns = self._at_ns(tick, started_ns)
        return State(
            room=ROOM,
            tick=tick,
            sim_time_s=tick / self.control_hz,
            stamps=TickStamps(due_ns=at_ns, fired_ns=at_ns, stepped_ns=at_ns, sent_ns=at_ns),
            real_time_factor=1.0,
            integration_state=self.integration_states[tick],
            arms=[self._arm(index, arm, tick) for index, arm in enumerate(self.task.arm_names)],
            observations=[
                Observation(name=name, value=values[tick].ravel().tolist())
                for name, values in self.observations.items()
            ],
            progress=self._progress(tick),
            episode=_NUMBER,
            episode_tick=tick,
            boot=started_ns,
        )

    def record(self, started_ns: int) -> EpisodeRecord:
        return EpisodeRecord(
            room=ROOM,
            number=_NUMBER,
            task=self.task.name,
            control_hz=self.control_hz,
            arms=self.task.arm_names,
            arm_kinds=self.task.arm_kinds,
            seed=self.seed,
            started_ns=started_ns,
            ended_ns=self._at_ns(self.ticks, started_ns),
            ticks=self.ticks,
            first_tick=0,
            last_tick=self.ticks,
            outcome=self.outcome,
            reason=self.reason,
            interrupted=False,
            complete=True,
        )

    def _at_ns(self, tick: int, started_ns: int) -> int:
        return started_ns + round(tick / self.control_hz * 1e9)

    def _arm(self, index: int, arm: str, tick: int) -> ArmState:
        x, y, z = self.observations[f"{arm}/tool_position_in_base"][tick].tolist()
        qw, qx, qy, qz = self.observations[f"{arm}/tool_quaternion_in_base"][tick].tolist()
        closed = self.observations.get(gripper_observation(arm))  # none of an arm without fingers
        return ArmState(
            arm=arm,
            tool_in_base=PoseMessage(x=x, y=y, z=z, qw=qw, qx=qx, qy=qy, qz=qz),
            gripper=0.0 if closed is None else float(closed[tick].item()),
            action=self.actions[tick - 1, index].tolist() if tick else [],
            sequence=tick,
            source=OPERATOR_POLICY,
            engaged=True,
            fresh=tick > 0,
        )

    def _progress(self, tick: int) -> Progress:
        ended = tick == self.ticks
        return Progress(
            subtasks=[
                Subtask(name=subtask.name, done=bool(done))
                for subtask, done in zip(self.task.subtasks, self.subtasks[tick], strict=True)
            ],
            success=ended and self.outcome == EpisodeOutcome.SUCCESS,
            failed=self.reason if ended and self.outcome == EpisodeOutcome.FAILURE else "",
        )


def write(path: Path, rollout: RolloutEpisode, model: Model, started_ns: int) -> None:
    """Write an episode file, complete before it has its name. model: of its world. started_ns: Unix time."""
    room = RoomRecord(
        room=ROOM,
        task=rollout.task.name,
        control_hz=rollout.control_hz,
        model_sha256=model.sha256,
        mujoco_version=model.mujoco_version,
        arm_kinds=rollout.task.arm_kinds,
    ).with_numerics(model.numerics)
    file = EpisodeWriter(path.with_name(f".{path.name}.half"))
    file.describe(room)
    file.attach_model(model, started_ns)
    for tick in range(rollout.ticks + 1):
        state = rollout.state(tick, started_ns)
        stamp_ns = state.stamps.sent_ns
        file.add(McapEntry(STATE, State, codec.encode(state), stamp_ns, stamp_ns, tick))
    for record in _records(rollout, started_ns):
        file.add_record(record.NAME, record.to_strings())
    file.finish()
    file.move_to(path)


def _records(
    rollout: RolloutEpisode, started_ns: int
) -> tuple[EpisodeRecord | OperatorsRecord | CadenceRecord | VerificationRecord, ...]:
    shift = Shift(episode_tick=0, operator=OperatorKind.POLICY, name=rollout.policy)
    time_s = rollout.ticks / rollout.control_hz
    return (
        rollout.record(started_ns),
        OperatorsRecord(shifts=dict.fromkeys(rollout.task.arm_names, (shift,))),
        CadenceRecord(wall_s=time_s, sim_s=time_s, missing_ticks=0, waited_s=0.0),
        VerificationRecord(
            verdict=Verdict.UNVERIFIED, detail="stepped by a replica, for an evaluation", pending=False
        ),
    )
