from __future__ import annotations

from mart.episodes.hand_faults import HandFaults
from mart.protocol.messages import (
    CUE_GO,
    HAND_FAULT_TRACKING,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    ArmState,
    Command,
    Event,
    Lane,
    Span,
    State,
)
from mart.recorder.catalogue.timeline import MAX_POINTS, MAX_SPANS, runs, timeline
from tests.recorder import synthetic


def state(tick: int, *, done: bool = False, late_s: float = 0.0, **arm: object) -> State:
    """Of one arm, one state a second."""
    made = State(tick=tick, arms=[ArmState(arm="arm0", fresh=tick > 0, source=OPERATOR_HUMAN)])
    made.stamps.stepped_ns = synthetic.START_NS + tick * 1_000_000_000
    made.progress.subtasks.add(name="lift", done=done)
    made.straggler, made.straggler_late_s = "arm0" if late_s else "", late_s
    for name, value in arm.items():
        setattr(made.arms[0], name, value)
    return made


def lane(lanes: list[Lane], kind: str) -> list[tuple[float, float, str]]:
    return [(span.begin_s, span.end_s, span.text) for one in lanes if one.kind == kind for span in one.spans]


def test_runs_meet_and_what_is_empty_is_none() -> None:
    assert runs([0.0, 1.0, 2.0, 3.0], ["", "a", "a", "b"]) == [
        Span(begin_s=1.0, end_s=3.0, text="a"),
        Span(begin_s=3.0, end_s=3.0, text="b"),
    ]


def test_it_tells_what_was_done_who_drove_and_for_whom_the_world_waited() -> None:
    states = [
        state(0),
        state(1, engaged=True),
        state(2, done=True, late_s=0.2),
        state(3, done=True, late_s=0.75, source=OPERATOR_POLICY),
        state(4, fresh=False),
    ]
    notice = Event(wall_ns=states[1].stamps.stepped_ns, notice=Event.Notice(text="The link broke."))
    cue = Event(wall_ns=states[2].stamps.stepped_ns, cue_given=Event.CueGiven(arm="arm0", cue=CUE_GO))
    details = timeline(
        states, [notice, cue, Event(wall_ns=1, notice=Event.Notice(text="before"))], HandFaults()
    )
    lanes = list(details.lanes)
    assert details.wall_s == 4.0
    assert lane(lanes, "subtask") == [(2.0, 4.0, "done")]
    assert lane(lanes, "driver") == [(0.0, 3.0, "human"), (3.0, 4.0, "policy"), (4.0, 4.0, "hold")]
    assert lane(lanes, "engaged") == [(1.0, 2.0, "engaged")]
    assert lane(lanes, "waiting") == [(2.25, 3.0, "")]
    assert lane(lanes, "cue") == [(2.0, 2.0, "go")]
    assert lane(lanes, "notice") == [(1.0, 1.0, "The link broke.")]


def test_it_tells_when_a_phone_was_lost() -> None:
    faults = HandFaults()
    for tick in (12, 13, 15):
        faults.add(Command(arm="arm0", state_tick=tick, hand_fault=HAND_FAULT_TRACKING))
    details = timeline([state(tick) for tick in range(10, 17)], [], faults)
    assert lane(list(details.lanes), "lost") == [(2.0, 4.0, "lost"), (5.0, 6.0, "lost")]


def test_where_the_wall_means_nothing_time_is_simulated() -> None:
    cue = Event(wall_ns=state(2).stamps.stepped_ns + 1, cue_given=Event.CueGiven(arm="arm0", cue=CUE_GO))
    early = Event(wall_ns=1, notice=Event.Notice(text="before"))
    details = timeline([state(tick) for tick in range(5)], [cue, early], HandFaults(), control_hz=20.0)
    assert (details.simulated, details.wall_s) == (True, 0.2)
    assert lane(list(details.lanes), "cue") == [(0.1, 0.1, "go")]
    assert lane(list(details.lanes), "notice") == []


def test_long_episodes_are_thinned() -> None:
    details = timeline([state(tick) for tick in range(3 * MAX_POINTS)], [], HandFaults())
    assert {len(trace.values) for trace in details.traces} == {MAX_POINTS}
    assert [(trace.arm, trace.quantity, trace.unit) for trace in details.traces] == [
        ("arm0", "height", "m"),
        ("arm0", "gripper", ""),
    ]


def test_what_is_told_is_bounded() -> None:
    """Whoever drives changes at every tick, of more arms than there are."""
    states = (
        state(tick, source=(OPERATOR_HUMAN, OPERATOR_POLICY)[tick % 2], late_s=1.0)
        for tick in range(3 * MAX_SPANS)
    )
    events = (Event(wall_ns=2**63, notice=Event.Notice(text="x" * 10_000)) for _ in range(2 * MAX_SPANS))
    details = timeline(states, events, HandFaults())
    assert max(len(one.spans) for one in details.lanes) == MAX_SPANS
    assert details.ByteSize() < 5_000_000


def test_states_that_do_not_agree_are_told_as_far_as_they_do() -> None:
    strange = State(tick=1, arms=[ArmState(arm="arm7", fresh=True)], straggler="arm7", straggler_late_s=9.0)
    strange.stamps.stepped_ns = synthetic.START_NS
    strange.arms[0].tool_in_base.z = float("nan")
    for order in ([state(0), strange, state(2)], [strange, state(0)], [strange, State()]):
        timeline(order, [], HandFaults()).SerializeToString()


def test_a_file_without_states_has_no_time() -> None:
    assert timeline([], [], HandFaults()).wall_s == 0.0
