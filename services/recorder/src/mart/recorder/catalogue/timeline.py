"""Tell what happened in an episode over time: who drove, what was done, for whom the world waited. Pure."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence

from mart.protocol.messages import CatalogueReply, Event, Lane, Span, State, Trace, cue_word, operator_word
from mart.protocol.vocabulary import OperatorKind

MAX_POINTS = 500
WAITED_S = 0.25  # what people are told of as it happens: a stall


def timeline(
    states: Sequence[State], events: Iterable[Event], control_hz: float | None = None
) -> CatalogueReply.Details:
    """Return `wall_s`, `lanes` and `traces`.

    Seconds are since the first state: simulated ones where `control_hz` is given, else the wall's.
    """
    if not states:
        return CatalogueReply.Details()
    stepped_ns = [state.stamps.stepped_ns for state in states]
    seconds = [(one_ns - stepped_ns[0]) / 1e9 for one_ns in stepped_ns]
    if control_hz is not None:
        seconds = [(state.tick - states[0].tick) / control_hz for state in states]

    def second_of(wall_ns: int) -> float:
        """Return when something was said; negative for what was said before."""
        if control_hz is None or wall_ns < stepped_ns[0]:
            return (wall_ns - stepped_ns[0]) / 1e9
        return seconds[bisect_right(stepped_ns, wall_ns) - 1]

    arms = range(len(states[0].arms))
    return CatalogueReply.Details(
        wall_s=seconds[-1],
        lanes=[
            *_subtasks(states, seconds),
            *(lane for arm in arms for lane in _of_arm(states, seconds, arm)),
            *_waiting(states, seconds),
            *_said(events, second_of),
        ],
        traces=[trace for arm in arms for trace in _traces(states, seconds, arm)],
        simulated=control_hz is not None,
    )


def runs(seconds: Sequence[float], values: Iterable[str]) -> list[Span]:
    """Return where a value stays the same; each run ends where the next begins. An empty value is no run."""
    found: list[Span] = []
    for now_s, value in zip(seconds, values, strict=True):
        if found:
            found[-1].end_s = now_s
        if not found or found[-1].text != value:
            found.append(Span(begin_s=now_s, end_s=now_s, text=value))
    return [span for span in found if span.text]


def _subtasks(states: Sequence[State], seconds: Sequence[float]) -> Iterator[Lane]:
    for index, subtask in enumerate(states[0].progress.subtasks):
        done = ("done" if state.progress.subtasks[index].done else "" for state in states)
        yield Lane(kind="subtask", name=subtask.name, spans=runs(seconds, done))


def _of_arm(states: Sequence[State], seconds: Sequence[float], index: int) -> Iterator[Lane]:
    """Tell who drove an arm, from the tick of their first command on, and where they moved it."""
    arms = [state.arms[index] for state in states]
    sources = [operator_word(arm.source) if arm.fresh else OperatorKind.HOLD.value for arm in arms]
    sources[0] = sources[min(1, len(sources) - 1)]  # the first state has had no command yet
    yield Lane(kind="driver", name=arms[0].arm, spans=runs(seconds, sources))
    engaged = ("engaged" if arm.fresh and arm.engaged else "" for arm in arms)
    yield Lane(kind="engaged", name=arms[0].arm, spans=runs(seconds, engaged))


def _waiting(states: Sequence[State], seconds: Sequence[float]) -> Iterator[Lane]:
    late: dict[str, list[Span]] = {}
    for state, now_s in zip(states, seconds, strict=True):
        if state.straggler and state.straggler_late_s >= WAITED_S:
            begin_s = max(0.0, now_s - state.straggler_late_s)
            late.setdefault(state.straggler, []).append(Span(begin_s=begin_s, end_s=now_s))
    for arm, spans in late.items():
        yield Lane(kind="waiting", name=arm, spans=spans)


def _said(events: Iterable[Event], second_of: Callable[[int], float]) -> Iterator[Lane]:
    """Tell what partners said to each other, and what the services said."""
    said: dict[tuple[str, str], list[Span]] = {}
    for event in events:
        match event.WhichOneof("what"):
            case "cue_given":
                lane, text = ("cue", event.cue_given.arm), cue_word(event.cue_given.cue)
            case "notice":
                lane, text = ("notice", ""), event.notice.text
            case _:
                continue
        if (at_s := second_of(event.wall_ns)) >= 0.0:
            said.setdefault(lane, []).append(Span(begin_s=at_s, end_s=at_s, text=text))
    for kind, name in sorted(said):
        yield Lane(kind=kind, name=name, spans=said[kind, name])


def _traces(states: Sequence[State], seconds: Sequence[float], index: int) -> Iterator[Trace]:
    every = -(-len(states) // MAX_POINTS)
    kept, at_s = [state.arms[index] for state in states[::every]], seconds[::every]
    name = states[0].arms[index].arm
    heights_m = [arm.tool_in_base.z for arm in kept]
    yield Trace(arm=name, quantity="height", unit="m", seconds=at_s, values=heights_m)
    yield Trace(arm=name, quantity="gripper", unit="", seconds=at_s, values=[arm.gripper for arm in kept])
