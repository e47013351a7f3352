"""Decide when the file of an episode may be closed. Pure; times are monotonic seconds.

States, commands, events and statuses come on ways of their own, so each may be behind the others, and any may be lost.
A file is closed a moment after all of it is there; where something is missing, after nothing more of it has come for a
while.
"""

from __future__ import annotations

from dataclasses import dataclass

from mart.episodes.mcap_entries import McapEntry
from mart.protocol.messages import Event, State
from mart.recorder.record.early_commands import EarlyCommands
from mart.recorder.record.episode_accumulator import EpisodeAccumulator

GRACE_S = 5.0  # how long a missing outcome, last state or command is awaited after anything else came
LINGER_S = 0.25  # the last tick's picture arrives after its state
SILENCE_S = 10.0  # neither state nor status: the sim is gone


@dataclass
class OpenEpisode:
    """Hold an episode whose file is open.

    early: commands that came before its states. moved_s: when something of it last came; state_s: when its newest state
    came. left: why the room is no longer at it, None while it is; no state of it can come then, for they come in order.
    """

    episode: EpisodeAccumulator
    early: EarlyCommands
    moved_s: float
    state_s: float
    left: str | None = None
    past: bool = False  # a status says that the room has gone on; its states may be behind
    whole_s: float | None = None  # since when nothing is missing

    def require_near(self, state: State, now_s: float) -> None:
        """Raise InvalidInput for a state of this episode that leaps beyond what the time since the newest permits."""
        self.episode.require_near(state, now_s - self.state_s)

    def take_state(self, now_s: float) -> None:
        """Take note that a state of it has come."""
        self.state_s = now_s
        self.move(now_s)

    def takes_event(self, event: Event) -> bool:
        """Tell whether an event belongs to it: it names the episode, or happened while the room was at it."""
        if event.HasField("episode_started"):
            return event.episode_started.number == self.episode.number
        if event.HasField("episode_ended"):
            return event.episode_ended.number == self.episode.number
        if self.left is None:
            return (
                not event.tick or event.tick >= self.episode.first_tick
            )  # what was before is heard again, too
        return self.episode.first_tick <= event.tick <= self.episode.last_tick

    def early_entries(self, state: State | None) -> list[McapEntry]:
        """Return, once, how the commands are written that came before its first state; see `EarlyCommands.take`."""
        taken = self.early.take(state)
        for arm, kept in taken:
            self.episode.add_command(arm, kept.command)
        return [kept.entry for _, kept in taken]

    def settle(self, now_s: float) -> None:
        """Take note of whether all is there now."""
        episode = self.episode
        states_there = episode.has_all or (episode.ended is not None and self.left is not None)
        if states_there and not episode.missing_commands:
            self.whole_s = now_s if self.whole_s is None else self.whole_s
        else:
            self.whole_s = None

    def move(self, now_s: float) -> None:
        """Take note that something of it has come."""
        self.moved_s = now_s
        self.settle(now_s)

    def leave(self, why: str, now_s: float) -> None:
        """Take note that the room is no longer at it."""
        if self.left is None:
            self.left = why
            self.move(now_s)

    def reason_to_close(self, now_s: float, heard_s: float) -> str | None:
        """Return why its file is to be closed now, None while it is not. heard_s: when the room was last heard."""
        if self.whole_s is not None:
            return "it is whole" if now_s >= self.whole_s + LINGER_S else None
        is_over = self.episode.ended is not None or self.left is not None or self.past
        if is_over and now_s >= self.moved_s + GRACE_S:
            return self.left or "its last states were lost"
        return "the sim fell silent" if now_s - heard_s > SILENCE_S else None

    def forgive(self, standstill_s: float) -> None:
        """Leave out time in which the recorder itself stood still."""
        self.moved_s += standstill_s
        if self.whole_s is not None:
            self.whole_s += standstill_s
