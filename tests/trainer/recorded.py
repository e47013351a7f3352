"""Real episodes: the sim's world and its scripted experts, written by the recorder's writer. No bus, no time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.episodes.mcap_entries import event_entry, state_entries, video_entry
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.messages import (
    OPERATOR_SCRIPT,
    OUTCOME_SUCCESS,
    ArmState,
    Event,
    Observation,
    Operator,
    Outcome,
    Seat,
    State,
    TickStamps,
    pose_message,
)
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import Verdict
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import describe_room, finalize, part_path
from mart.recorder.record.room_facts import RoomFacts
from mart.sim.experts import Expert, get_skill
from mart.sim.world import World
from mart.sim.world.model_message import model_message

TASK = "two_arm_multi_cube_lifting"
ROOM = "room-1"
PERIOD_NS = 50_000_000
START_NS = 1_790_000_000_000_000_000  # 2026-09-21, UTC
_MOST_TICKS = 400

Source = Callable[[int, int], Operator]  # of a tick and an arm's index


def by_scripts(_tick: int, _arm: int) -> Operator:
    return OPERATOR_SCRIPT


def perform(
    world: World, seed: int, number: int = 1, source: Source = by_scripts, most_ticks: int = _MOST_TICKS
) -> list[State]:
    """The states of one episode, from the reset to success, or so many ticks."""
    world.reset(seed)
    randoms = np.random.default_rng(seed).spawn(len(world.arms))
    experts = {
        arm: Expert(world.task, arm, get_skill("expert"), random)
        for arm, random in zip(world.arms, randoms, strict=True)
    }
    targets = {arm: world.tool_pose_in_base(arm) for arm in world.arms}
    states = [state_of(world, number, 0, None, source)]
    while not world.progress().success and len(states) <= most_ticks:
        actions = []
        for arm, expert in experts.items():
            intent = expert.act(world.observations_for(arm), world.sim_time_s)
            if intent.engaged:
                targets[arm] = intent.pose_tool_in_base
            actions.append(world.action_for(arm, targets[arm], intent.gripper))
        world.step(actions)
        states.append(state_of(world, number, len(states), np.array(actions), source))
    return states


def write(
    root: Path,
    world: World,
    states: Sequence[State],
    *,
    task: str = TASK,
    control_hz: float = 20.0,
    outcome: Outcome = OUTCOME_SUCCESS,
    verdict: Verdict = Verdict.VERIFIED,
    name: str = "expert",
    with_model: bool = False,
    captured: Mapping[str, Sequence[tuple[int, bytes]]] | None = None,
) -> Path:
    """An episode file as the recorder leaves it. captured: by real camera, its encoded pictures, each with its time."""
    first, last = states[0], states[-1]
    seats = [
        Seat(arm=arm.arm, operator=OPERATOR_SCRIPT, epoch=arm.seat_epoch, name=name) for arm in first.arms
    ]
    started = Event.EpisodeStarted(
        number=first.episode,
        seats=seats,
        task=task,
        control_hz=control_hz,
        model_sha256=world.model_sha256,
        captured_cameras=[*(captured or {})],
    )
    ended = Event.EpisodeEnded(
        number=first.episode, outcome=outcome, ticks=last.episode_tick, last_tick=last.tick
    )
    events = (
        Event(wall_ns=first.stamps.sent_ns, room=ROOM, tick=first.tick, episode_started=started),
        Event(wall_ns=last.stamps.sent_ns, room=ROOM, tick=last.tick, episode_ended=ended),
    )
    facts, episode = RoomFacts(ROOM, arm_kinds=world.task.arm_kinds), EpisodeAccumulator(first)
    for event in events:
        facts.learn_event(event)
        episode.add_event(event)
    if with_model:
        facts.learn_model(model_message(world))
    file = EpisodeWriter(part_path(root, episode, facts))
    describe_room(file, facts, model_message(world) if with_model else None)
    for camera, pictures in (captured or {}).items():
        for at_ns, data in pictures:
            video = CompressedVideo(frame_id=camera, data=data, format="h264")
            video.timestamp.FromNanoseconds(at_ns)
            file.add(video_entry(camera, video, codec.encode(video), at_ns))
    for event in events:
        file.add(event_entry(event, codec.encode(event), event.wall_ns))
    for state in states:
        episode.add_state(state, state.stamps.sent_ns)
        for entry in state_entries(state, codec.encode(state), state.stamps.sent_ns, task):
            file.add(entry)
    said = VerificationRecord(verdict=verdict, detail="")

    def verify(_file: EpisodeFile, _room: RoomRecord) -> VerificationRecord:
        return said

    return finalize(file, episode, facts, root, verify, repaired=False).path


def state_of(
    world: World, number: int, tick: int, actions: np.ndarray | None, source: Source = by_scripts
) -> State:
    """The state as a room would send it. actions: what was applied in this tick; None after the reset."""
    seen = world.observations()
    stamp_ns = START_NS + number * 10**12 + tick * PERIOD_NS
    arms = [
        ArmState(
            arm=arm,
            tool_in_base=pose_message(world.tool_pose_in_base(arm)),
            gripper=world.gripper(arm),
            action=[] if actions is None else actions[index].tolist(),
            source=source(tick, index),
            seat_epoch=1,
            sequence=tick,
            fresh=tick > 0,
        )
        for index, arm in enumerate(world.arms)
    ]
    return State(
        room=ROOM,
        tick=tick + 1,
        sim_time_s=world.sim_time_s,
        stamps=TickStamps(due_ns=stamp_ns, fired_ns=stamp_ns, stepped_ns=stamp_ns, sent_ns=stamp_ns),
        integration_state=world.integration_state(),
        arms=arms,
        observations=[Observation(name=name, value=value.ravel()) for name, value in seen.items()],
        episode=number,
        episode_tick=tick,
        boot=7,
    )
