"""An episode of minutes at real size: three arms at 20 Hz, commands at 60 Hz, packets of video; written as recorded."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mart.episodes.mcap_entries import command_entry, event_entry, state_entries, video_entry
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    ArmState,
    Command,
    Event,
    Model,
    Numerics,
    PoseMessage,
    RolloutReply,
    RolloutRequest,
    Seat,
    State,
)
from mart.protocol.state_digest import state_digest
from mart.protocol.tasks import get_task
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import SavedEpisode, finalize, part_path
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.verify.resimulation import verify
from tests.recorder import synthetic

ARMS = ("arm0", "arm1", "arm2")
HZ = 20
COMMANDS_A_TICK = 3
_STATE_REPEATS = 75  # of a toy state of 64 bytes: 4.8 kB, as that of three arms and their cubes
_KEY_EVERY = 40
_PACKET_BYTES = (12_000, 2_200)  # of a whole picture, and of one that follows: some 0.4 Mbit/s
_FLUSH_EVERY = 10
MODEL = Model(
    sha256=synthetic.MODEL.sha256, mjb=synthetic.MJB, task=synthetic.TASK, control_hz=HZ, arms=ARMS,
    mujoco_version="4.0.0", numerics=synthetic.NUMERICS,
)  # fmt: skip


def write_long_episode(root: Path, minutes: float) -> SavedEpisode:
    """Write an episode as a recorder does, verified and complete; memory must not grow with its length."""
    states = long_states(round(minutes * 60 * HZ))
    first = next(states)
    facts = RoomFacts(synthetic.ROOM)
    beginning = beginning_of(synthetic.ROOM)
    facts.learn_event(beginning)
    facts.learn_model(MODEL)
    episode = EpisodeAccumulator(first)
    episode.add_event(beginning)
    file = EpisodeWriter(part_path(root, episode, facts))
    file.describe(facts.record())
    file.attach_model(MODEL, synthetic.wall_ns(0))
    file.add(event_entry(beginning, codec.encode(beginning), beginning.wall_ns))
    packets = Packets()
    last = first
    _write_tick(file, episode, first, packets)
    for state in states:
        _write_tick(file, episode, state, packets)
        last = state
    end = synthetic.ended(last.tick)
    episode.add_event(end)
    file.add(event_entry(end, codec.encode(end), end.wall_ns))
    return finalize(file, episode, facts, root, lambda one, room: verify(one, room, replica), repaired=False)


def beginning_of(room: str) -> Event:
    """The event by which such an episode begins."""
    event = synthetic.started()
    event.room = room
    del event.episode_started.seats[:]
    event.episode_started.seats.extend(Seat(arm=arm, operator=OPERATOR_HUMAN, epoch=3) for arm in ARMS)
    return event


def commands_before(tick: int, arm: str) -> list[Command]:
    """The commands of one arm that come before a tick."""
    begin = max(0, tick - 1) * COMMANDS_A_TICK
    return [synthetic.command(begin + number + 1, arm) for number in range(COMMANDS_A_TICK if tick else 0)]


def replica(request: RolloutRequest) -> RolloutReply:
    """Step the toy world of this size again."""
    asked = request.resimulate
    actions = np.frombuffer(asked.actions, "<f8").reshape(-1, asked.arms, 7)
    world, digests = asked.first_state[:64], b""
    for done in actions:
        world = synthetic.step(world, done)
        digests += state_digest(world * _STATE_REPEATS)
    return RolloutReply(state_digests=digests, numerics=Numerics(processor="toy", fingerprint="aa"))


def long_states(ticks: int, room: str = synthetic.ROOM) -> Iterator[State]:
    """The states of an episode of three arms, with observations and integration states of real size."""
    observations = {
        one.name: int(np.prod(one.shape)) for one in get_task(synthetic.TASK, len(ARMS)).observations
    }
    world = synthetic.RESET
    for tick in range(ticks + 1):
        actions = [synthetic.action(tick, arm) for arm in range(len(ARMS))]
        if tick:
            world = synthetic.step(world, np.array(actions))
        state = synthetic.states(0, first_tick=tick, room=room)[0]
        state.episode_tick, state.sim_time_s = tick, tick / HZ
        state.integration_state = world * _STATE_REPEATS
        del state.arms[:]
        state.arms.extend(_arm(tick, index, arm, actions[index]) for index, arm in enumerate(ARMS))
        for name, size in observations.items():
            state.observations.add(name=name, value=np.sin(0.01 * tick + np.arange(size)))
        yield state


def _arm(tick: int, index: int, arm: str, action: list[float]) -> ArmState:
    return ArmState(
        arm=arm,
        tool_in_base=PoseMessage(x=0.5 + 0.1 * np.sin(tick / 30 + index), y=0.1, z=0.3, qw=1.0),
        gripper=0.25,
        action=action if tick else [],
        sequence=tick * COMMANDS_A_TICK,
        source=OPERATOR_HUMAN,
        seat_epoch=3,
        fresh=tick > 0,
    )


class Packets:
    """Hold bytes that nothing packs smaller, as those of encoded video are."""

    def __init__(self) -> None:
        self._bytes = random.Random(1).randbytes(1 << 20)

    def of(self, tick: int, arm: int) -> bytes:
        """The packet of a picture; its units have the right types."""
        head = b"\x00\x00\x00\x01" + (b"\x41" if tick % _KEY_EVERY else b"\x67")
        size = _PACKET_BYTES[tick % _KEY_EVERY > 0]
        at = (tick * 7919 + arm * 104729) % (len(self._bytes) - size)
        return head + self._bytes[at : at + size]


def _write_tick(file: EpisodeWriter, episode: EpisodeAccumulator, state: State, packets: Packets) -> None:
    at_ns, tick = synthetic.wall_ns(state.tick), state.episode_tick
    for index, arm in enumerate(ARMS):
        for command in commands_before(tick, arm):
            episode.add_command(arm, command)
            file.add(command_entry(arm, command, codec.encode(command), at_ns))
        video = synthetic.video(tick, is_key=False, data=packets.of(tick, index))
        file.add(video_entry(arm, video, codec.encode(video), at_ns))
    episode.add_state(state, at_ns)
    for entry in state_entries(state, codec.encode(state), at_ns, synthetic.TASK):
        file.add(entry)
    if tick % _FLUSH_EVERY == 0:
        file.flush()
