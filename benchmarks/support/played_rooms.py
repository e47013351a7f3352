"""Rooms that a recorder hears of, without physics: states, commands and packets of video at real size and pace."""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import islice

from mart.protocol import clock, codec, keys
from mart.protocol.messages import OUTCOME_SUCCESS, Event, RecordingReport
from mart.protocol.recording import STATE, command_topic, video_topic
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Sample
from tests.recorder import synthetic
from tests.recorder.long_episode import ARMS, HZ, MODEL, Packets, beginning_of, commands_before, long_states

_AHEAD = 40  # states that are made beforehand


class PlayedRoom:
    """Play one room of three arms.

    lag_s: of each report of the recorder, how old the oldest state was that it lacked.
    sent: by kind each message from the first second of the episode on, as its topic in the file and its number; what
    came before, a recorder may have heard before it knew that the room was alive. messages: how many there were in all.
    """

    def __init__(self, name: str, bus: Bus, video_bus: Bus) -> None:
        self.name, self.lag_s = name, list[float]()
        self.sent: dict[str, set[tuple[str, int]]] = {
            kind: set() for kind in ("states", "commands", "pictures")
        }
        self.messages = 0
        self._bus, self._packets = bus, Packets()
        self._state, self._event = bus.publisher(keys.state(name)), bus.publisher(keys.event(name))
        self._commands = {arm: bus.publisher(keys.command(name, arm)) for arm in ARMS}
        self._videos = {arm: video_bus.publisher(keys.video(name, arm)) for arm in ARMS}
        self._sent_s = list[float]()
        bus.serve(keys.model(name), lambda request: request.reply(codec.encode(MODEL)))
        bus.subscribe(keys.recording(name).key, self._hear)
        bus.announce(keys.alive(ServiceKind.SIM, name))

    def begin(self, ticks: int) -> None:
        """Announce an episode of so many ticks."""
        self._states = long_states(ticks, self.name)
        self._ready = list(islice(self._states, _AHEAD))
        self._tell(beginning_of(self.name))

    def tick(self) -> None:
        """Send the next state, and what comes before it."""
        state = self._ready.pop(0)
        tick, now_ns = state.episode_tick, clock.wall_ns()
        for index, arm in enumerate(ARMS):
            for command in commands_before(tick, arm):
                command.stamps.sent_ns = now_ns
                self._commands[arm].put(codec.encode(command))
                self._note("commands", tick, command_topic(arm), command.sequence)
            video = synthetic.video(0, is_key=False, data=self._packets.of(tick, index))
            video.frame_id = arm
            video.timestamp.FromNanoseconds(now_ns)
            self._videos[arm].put(codec.encode(video))
            self._note("pictures", tick, video_topic(arm), now_ns)
        for name in ("due_ns", "fired_ns", "stepped_ns", "sent_ns"):
            setattr(state.stamps, name, now_ns)
        self._sent_s.append(time.monotonic())
        self._state.put(codec.encode(state))
        self._note("states", tick, STATE, state.tick)
        self._ready += islice(self._states, 1)

    def end(self) -> None:
        """Say that the episode is over."""
        event = synthetic.ended(len(self._sent_s) - 1, outcome=OUTCOME_SUCCESS)
        event.room = self.name
        self._tell(event)

    def _note(self, kind: str, tick: int, topic: str, number: int) -> None:
        self.messages += 1
        if tick >= HZ:
            self.sent[kind].add((topic, number))

    def _tell(self, event: Event) -> None:
        event.wall_ns = clock.wall_ns()
        self._event.put(codec.encode(event))

    def _hear(self, sample: Sample) -> None:
        last = codec.decode(RecordingReport, sample.payload).last_tick
        missing = self._sent_s[last + 1 : last + 2]
        self.lag_s.append(time.monotonic() - missing[0] if missing else 0.0)


def play(rooms: list[PlayedRoom], seconds: float, every_second: Callable[[], None]) -> float:
    """Play rooms at their pace, each tick a little after another's; returns by how much it was late at most."""
    ticks, latest_s = round(seconds * HZ), 0.0
    for room in rooms:
        room.begin(ticks)
    began_s = time.monotonic()
    for tick in range(ticks + 1):
        for number, room in enumerate(rooms):
            due_s = began_s + (tick + number / len(rooms)) / HZ
            time.sleep(max(0.0, due_s - time.monotonic()))
            latest_s = max(latest_s, time.monotonic() - due_s)
            room.tick()
        if tick % HZ == 0:
            every_second()
    for room in rooms:
        room.end()
    return latest_s
