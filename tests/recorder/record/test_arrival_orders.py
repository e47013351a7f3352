"""States, commands, events and statuses overtake each other and are lost: all is in the file, or the count is right."""

from __future__ import annotations

from functools import cache
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol import recording
from mart.protocol.messages import (
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    Command,
    Event,
    RoomStatus,
    State,
)
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.episode_closing import GRACE_S
from mart.recorder.record.room_tracker import CloseFile, OpenFile
from tests.recorder import synthetic
from tests.recorder.record.driven_room import DrivenRoom, practice

Word = State | Command | Event | RoomStatus
NUMBERS = (1, 2)


@cache
def episode_states(number: int) -> list[State]:
    """Of seven, whose commands are numbered on through both episodes."""
    states = synthetic.states(6, number=number, first_tick=20 * number)
    for state in states:
        if state.arms[0].fresh:
            state.arms[0].sequence = 20 * number + 2 * state.episode_tick
    return states


def ended_status(number: int, at_number: int, phase: int) -> RoomStatus:
    status = synthetic.episode_status(0, number=at_number, phase=phase)  # type: ignore[arg-type]
    status.last_ended.CopyFrom(synthetic.ended(20 * number + 6, number).episode_ended)
    return status


def streams() -> list[list[Word]]:
    """What a room says, each stream in its own order: the streams overtake each other."""
    states = [
        practice(19),
        *episode_states(1),
        practice(30),
        *episode_states(2),
        practice(50),
    ]
    commands = [synthetic.command(sequence) for sequence in range(18, 60)]
    events = [
        event
        for number in NUMBERS
        for event in (synthetic.started(number, 20 * number), synthetic.ended(20 * number + 6, number))
    ]
    statuses = [
        ended_status(1, 1, EPISODE_PHASE_PRACTICE),
        ended_status(1, 2, EPISODE_PHASE_RECORDING),
        ended_status(2, 2, EPISODE_PHASE_PRACTICE),
    ]
    return [states, commands, events, statuses]  # type: ignore[list-item]


class Arrivals:
    """What comes, and what is lost on the way."""

    def __init__(self) -> None:
        self.came: list[Word] = []
        self.lost: list[Word] = []

    def __repr__(self) -> str:
        return " ".join(map(_short, self.came))


def _short(word: Word) -> str:
    match word:
        case State():
            return f"state{word.tick}"
        case Command():
            return f"command{word.sequence}"
        case Event():
            return f"{word.WhichOneof('what')}{word.tick}"
        case _:
            return f"status{word.episode.number}"


@st.composite
def arrivals(draw: st.DrawFn) -> Arrivals:
    """Any interleaving; few or many are lost; commands may come twice or out of order among themselves."""
    random = Random(draw(st.integers(0, 2**32)))
    left = streams()
    if draw(st.booleans()):
        random.shuffle(left[1])
    loss = draw(st.sampled_from([0.0, 0.1, 0.5]))
    weights = [draw(st.sampled_from([1, 1, 5, 100])) for _ in left]
    made = Arrivals()
    while any(left):
        chosen = [index for index, words in enumerate(left) for _ in range(weights[index] if words else 0)]
        word = left[random.choice(chosen)].pop(0)
        if random.random() < loss:
            made.lost.append(word)
        else:
            made.came += [word] * random.choice([1, 1, 1, 2])
    return made


def driven(arrived: Arrivals) -> DrivenRoom:
    room = DrivenRoom()
    for word in arrived.came:
        if isinstance(word, State):
            room.only_state(word)
        elif isinstance(word, Command):
            room.command(word)
        elif isinstance(word, Event):
            room.event(word)
        else:
            room.status(word)
        room.wait(0.01)
    room.wait(4 * GRACE_S)
    return room


@settings(max_examples=60)
@given(arrivals())
def test_every_state_that_came_is_in_one_file_in_order(arrived: Arrivals) -> None:
    room = driven(arrived)
    closed = {action.episode.number: action.episode for action in room.closed}
    assert len(closed) == len(room.closed)
    assert room.course.count(OpenFile) == room.course.count(CloseFile) == len(closed)
    for number in NUMBERS:
        came = sorted({w.tick for w in arrived.came if isinstance(w, State) and w.episode == number})
        if came:
            episode = closed[number]
            assert room.sequences(episode, recording.STATE) == came
            assert episode.missing_ticks == came[-1] - came[0] + 1 - len(came)


@settings(max_examples=60)
@given(arrivals())
def test_every_command_that_states_name_is_in_the_file_or_counted(arrived: Arrivals) -> None:
    room = driven(arrived)
    came = {word.sequence for word in arrived.came if isinstance(word, Command)}
    for action in room.closed:
        named = named_in(room, action.episode)
        there = set(room.sequences(action.episode, recording.command_topic("arm0")))
        assert named & came <= there
        assert action.episode.missing_commands == len(named - there)
        assert action.episode.cadence().missing_commands == len(named - came)


def named_in(room: DrivenRoom, episode: EpisodeAccumulator) -> set[int]:
    """The numbers of the commands that an episode's recorded states name; its first state comes from no tick."""
    ticks = room.sequences(episode, recording.STATE)[1:]
    states = {state.tick: state for state in episode_states(episode.number)}
    return {arm.sequence for tick in ticks for arm in states[tick].arms if arm.fresh}


@settings(max_examples=60)
@given(arrivals())
def test_an_outcome_is_known_where_any_word_of_it_came(arrived: Arrivals) -> None:
    room = driven(arrived)
    for action in room.closed:
        number = action.episode.number
        events = any(
            isinstance(w, Event) and w.HasField("episode_ended") and w.episode_ended.number == number
            for w in arrived.came
        )
        statuses = any(isinstance(w, RoomStatus) and w.last_ended.number == number for w in arrived.came)
        record = action.episode.record(room.tracker.facts)
        if events or statuses:
            assert record.outcome == "success"
        else:
            assert record.outcome == "unspecified"
