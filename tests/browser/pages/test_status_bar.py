"""What the status bar says and offers in every state, how it goes, and what the phone's coach asks for."""

from __future__ import annotations

from typing import Any

import pytest

from tests.browser.pages.conftest import Run

CUBE = {"title": "The blue cube is up", "arms": ["arm0"], "done": False}
LIVE = {"state": "live", "problem": "", "role": "browser"}


def seat(arm: str = "arm0", operator: str = "human", name: str = "Ana", **more: Any) -> dict[str, Any]:
    return {"arm": arm, "operator": operator, "name": name, "ready": False, "mine": False, "epoch": 7, **more}


def room(*seats: dict[str, Any], phase: str = "practice", **episode: Any) -> dict[str, Any]:
    return {
        "seats": list(seats),
        "stale": False,
        "last_episode": None,
        "unrecorded": "",
        "plan": None,
        "progress": {"subtasks": [CUBE] * 3, "success": False},
        "barrier": "running",
        "instruction": "Lift.",
        "time_limit_s": 15,
        "episode": {"phase": phase, "elapsed_s": 0, "remaining_s": 0, "outcome": "", "reason": "", **episode},
    }


def view(run: Run, the_room: dict[str, Any] | None, **more: Any) -> dict[str, Any]:
    known = {"room": the_room, "seat": the_room and the_room["seats"][0], "link": LIVE, **more}
    shown: dict[str, Any] = run(
        "hud/status-bar-view.js", "({ statusBarView }, known) => statusBarView(known)", known
    )
    shown["primary"] = [action["command"] for action in shown["actions"] if action.get("look") == "primary"]
    shown["actions"] = [action["command"] for action in shown["actions"]]
    return shown


MINE = seat(mine=True)
RELIEVING = seat(mine=True, relieved="lifter")
WAITING = {"arm": "arm1", "name": "Ben"}
OUTCOMES = ["success", "failure", "discard"]
READY = seat(mine=True, ready=True)
SAVED = {"path": "episodes/x.mcap", "verified": True, "verdict": "", "size_bytes": 2_345_678}
LAST = {"number": 1, "outcome": "failure", "reason": "time is up", "since_s": 1.0, "epochs": {"arm0": 7}}


def after(*, saved: dict[str, Any] | None = SAVED, **last: Any) -> dict[str, Any]:
    """A room in practice after an episode of the same people."""
    return room(MINE) | {"last_episode": LAST | {"saved": saved} | last}


@pytest.mark.parametrize(
    ("the_room", "label", "actions"),
    [
        (room(MINE), "Practice", ["ready", "reset"]),
        (room(READY, seat("arm1", name="Ben")), "Ready", ["unready"]),
        (room(MINE, phase="countdown", remaining_s=2.2), "Starts in", []),
        (room(MINE, phase="recording", elapsed_s=42.9), "Recording", OUTCOMES),
        (room(MINE, phase="ended", outcome="failure", reason="time is up"), "Failed", []),
        (room(seat(operator="hold", name="")), "Free seat", ["take"]),
        (room(seat(operator="script", name="")), "Practice", ["take", "ready"]),
        (room(seat(operator="policy", name="lifter"), phase="recording"), "Recording", ["take", *OUTCOMES]),
        (room(seat(operator="policy", name="lifter"), seat("arm1")), "Practice", ["take"]),
        (room(RELIEVING), "Practice", ["ready", "reset", "back"]),
        (room(RELIEVING, phase="recording"), "Recording", [*OUTCOMES, "back"]),
        (room(seat(name="Ben")), "Watching", ["lobby"]),
        (room(seat(operator="hold", name=""), seat("arm1", mine=True)), "Watching", ["lobby"]),
        (None, "No such seat", ["lobby"]),
        (room(MINE) | {"stale": True}, "The simulation does not answer", []),
        (room(MINE) | {"barrier": "stopped"}, "Stopped", []),
        (room(MINE) | {"barrier": "stopped", "stop": {"name": "Hanna", "by_host": True}}, "Paused", []),
    ],
)
def test_every_state_has_its_words_and_its_next_action(
    run: Run, the_room: dict[str, Any] | None, label: str, actions: list[str]
) -> None:
    shown = view(run, the_room)
    assert (shown["label"], shown["actions"]) == (label, actions)


def test_figures(run: Run) -> None:
    recording = view(run, room(MINE, phase="recording", elapsed_s=42.9))
    assert (recording["figure"], recording["limit"]) == ("0:42", "of 0:15")
    assert view(run, room(MINE, phase="countdown", remaining_s=2.2))["figure"] == "3"
    assert view(run, room(MINE, phase="countdown", remaining_s=0.0))["figure"] == "1"


@pytest.mark.parametrize(
    ("plan", "words"),
    [
        (None, ""),
        ({"episodes": 50, "good": 2}, "Episode 3 of 50"),
        ({"episodes": 50, "good": 51}, "All 50 episodes recorded"),
        ({"episodes": 1, "good": 1}, "Planned episode recorded"),
    ],
)
def test_the_plan_is_told_and_stops_nobody(run: Run, plan: dict[str, int] | None, words: str) -> None:
    for phase in ("practice", "countdown", "recording", "ended"):
        assert view(run, room(MINE, phase=phase) | {"plan": plan})["plan"] == words
    shown = view(run, room(MINE) | {"plan": plan})
    assert shown["actions"] == ["ready", "reset"]
    assert ("you may go on" in shown["hint"]) == ("recorded" in words)


def test_a_seat_that_is_kept_for_somebody_away_says_for_how_long(run: Run) -> None:
    away = seat("arm1", name="Ben", kept_s=19.2)
    assert view(run, room(READY, away))["detail"] == "Waiting for Ben (away, seat kept for 20 s more)."
    assert view(run, room(seat(name="Ben", kept_s=19.2)))["detail"] == "Kept for Ben for 20 s more."
    waiting_text = "({ waitingText }, room) => waitingText(room)"
    paused = room(MINE, away) | {"barrier": "paused", "waiting_for": [WAITING | {"since_s": 10.8}]}
    assert run("formatting.js", waiting_text, paused) == "Paused, waiting for Ben, at most 20 s more"
    script = seat("arm1", operator="script", kept_s=0.0)
    assert run("formatting.js", waiting_text, paused | {"seats": [MINE, script]}).endswith("arm, 10.8 s")
    stalled = paused | {"barrier": "stalled", "waiting_for": [WAITING | {"since_s": 0.8}]}
    assert run("formatting.js", waiting_text, stalled) == "Waiting for Ben, 0.8 s"


def test_an_arm_that_a_step_needs_and_nobody_drives_is_named_before_recording(run: Run) -> None:
    idle = room(MINE, seat("arm1", operator="hold", name=""))
    assert view(run, idle)["warning"] == ""  # no step needs it
    column = {"title": "Column 1 stands", "arms": ["arm1"], "done": False}
    tabletop = {"title": "The tabletop is up", "arms": ["arm0", "arm1"], "done": False}
    idle["progress"]["subtasks"] = [CUBE, column, tabletop]
    words = (
        "Nobody drives the orange arm; without it there is no success: “Column 1 stands”, “The tabletop is up”. "
        "Use a script there, or let somebody take the seat."
    )
    shown = view(run, idle)
    assert (shown["warning"], shown["actions"]) == (words, ["ready", "reset"])
    assert view(run, idle | {"episode": idle["episode"] | {"phase": "countdown"}})["warning"] == words
    assert view(run, idle | {"episode": idle["episode"] | {"phase": "recording"}})["warning"] == ""
    idle["seats"][1]["operator"] = "script"
    assert view(run, idle)["warning"] == ""


def test_people_are_named_when_they_wait_for_each_other(run: Run) -> None:
    assert "Waiting for Ben" in view(run, room(READY, seat("arm1", name="Ben")))["detail"]
    assert "Ben is ready" in view(run, room(MINE, seat("arm1", name="Ben", ready=True)))["detail"]


@pytest.mark.parametrize(
    ("outcome", "label", "actions", "words"),
    [
        ("success", "Success", ["ready", "reset"], "Saved and verified: episodes/x.mcap (2.3 MB)."),
        ("unspecified", "Interrupted", ["ready", "reset"], "Saved and verified: episodes/x.mcap (2.3 MB)."),
        ("discarded", "Discarded", ["ready", "keep", "reset"], "left out of data sets: episodes/x.mcap"),
    ],
)
def test_after_an_episode_the_file_is_named(
    run: Run, outcome: str, label: str, actions: list[str], words: str
) -> None:
    shown = view(run, after(outcome=outcome))
    assert (shown["label"], shown["actions"]) == (label, actions)
    assert words in shown["detail"]
    assert shown["primary"] == ["ready"]


def test_an_episode_is_told_from_its_end_until_the_next_one_begins(run: Run) -> None:
    ended = view(run, room(MINE, phase="ended", outcome="failure", reason="time is up"))
    saving, saved = view(run, after(saved=None)), view(run, after())
    assert (ended["label"], ended["detail"]) == ("Failed", "Time is up. Saving…")
    assert (saving["label"], saving["detail"]) == ("Failed", "Time is up. Saving…")
    assert (saved["label"], saved["detail"][:32]) == ("Failed", "Time is up. Saved and verified: ")
    assert "Not saved yet, 42.0 s" in view(run, after(saved=None, since_s=42.0))["detail"]


def test_a_success_by_hand_says_how_far_it_was(run: Run) -> None:
    by_hand = after(outcome="success", reason="said by Ana", ended_by="operator", subtasks_done=0, subtasks=3)
    assert "Said by Ana. 0 of 3 steps were done. Saved" in view(run, by_hand)["detail"]
    too_late = after(outcome="failure", reason="time is up", ended_by="time", subtasks_done=1, subtasks=2)
    assert "Time is up. 1 of 2 steps were done. Saved" in view(run, too_late)["detail"]


def test_what_nobody_keeps_is_not_called_a_recording(run: Run) -> None:
    shown = view(run, room(MINE, phase="recording") | {"unrecorded": "no recorder runs"})
    assert (shown["label"], shown["detail"], shown["recording"]) == (
        "Not recorded",
        "No recorder runs.",
        False,
    )


def test_whoever_sits_down_afterwards_is_told_of_the_goal_instead(run: Run) -> None:
    assert view(run, after(epochs={"arm0": 6}))["label"] == "Practice"


def test_no_button_is_meant_while_it_records_and_open_steps_are_asked_about(run: Run) -> None:
    recording = room(MINE, phase="recording")
    assert view(run, recording)["primary"] == []
    assert "0 of 3 steps are done" in view(run, recording, pending="success")["detail"]
    assert "steps" not in view(run, recording, pending="failure")["detail"]


def test_practice_says_the_goal_and_that_it_was_reached(run: Run) -> None:
    assert view(run, room(MINE))["detail"] == "Lift."
    reached = view(run, room(MINE), reached=True)
    assert (reached["label"], reached["primary"]) == ("That is it!", ["ready"])


def test_what_to_do_now_is_said_while_one_can_do_it(run: Run) -> None:
    told = {"to_do": {"arm0": "Grip the lid.", "arm1": "Wait."}}
    practice, recording = (view(run, room(MINE, phase=phase) | told) for phase in ("practice", "recording"))
    assert (practice["now"], practice["goal"], practice["detail"]) == ("Grip the lid.", "Lift.", "")
    assert (recording["now"], recording["goal"]) == ("Grip the lid.", "Lift.")
    assert "Success is seen" in recording["hint"]
    assert not view(run, room(READY, seat("arm1", name="Ben")) | told).get("now")
    assert not view(run, after() | told).get("now")
    assert not view(run, room(MINE) | told | {"barrier": "stopped"}).get("now")


def test_a_lost_connection_is_said(run: Run) -> None:
    lost = view(run, room(MINE), link=LIVE | {"state": "silent"})
    assert lost["label"] == "Connection lost"
    refused = view(run, room(MINE), link=LIVE | {"state": "connecting", "problem": "No gateway is running."})
    assert refused["detail"] == "No gateway is running."


def test_a_replaced_page_waits_to_be_asked(run: Run) -> None:
    shown = view(run, room(MINE), link=LIVE | {"state": "replaced"})
    assert (shown["label"], shown["actions"]) == ("Driven elsewhere", ["here"])


def test_a_newcomer_is_told_the_first_moves(run: Run) -> None:
    assert "Hold space" in view(run, room(MINE), isNew=True)["hint"]
    assert "Two fingers" in view(run, room(MINE), isNew=True, touch=True)["hint"]
    assert "Nothing is recorded" in view(run, room(MINE), isNew=False)["hint"]


@pytest.mark.parametrize(
    ("changes", "shown"),
    [
        ({}, ("good", "good", "60 ms")),
        ({"delay": 150}, ("fair", "fair", "150 ms")),
        ({"delay": 900}, ("slow", "slow", "900 ms")),
        ({"factor": 0.9}, ("fair", "slow world", "60 ms")),
        ({"factor": 0.03}, ("slow", "slow world", "60 ms")),
        ({"factor": 0.03, "delay": 900, "forMs": 900}, ("none", "starting", "900 ms")),
        ({"forMs": 900}, ("good", "good", "60 ms")),
        ({"factor": 0.03, "slow": False}, ("good", "good", "60 ms")),
        ({"factor": 0.03, "delay": 900}, ("slow", "slow world", "900 ms")),
        ({"factor": 0.9, "delay": 900}, ("slow", "slow", "900 ms")),
        ({"still": True}, ("slow", "picture stands still", "60 ms")),
        ({"told": False}, ("none", "No link", "– ms")),
        ({"live": False}, ("none", "No link", "– ms")),
        ({"barrier": "stopped", "live": False}, ("none", "Stopped", "– ms")),
        ({"barrier": "paused"}, ("none", "Paused", "– ms")),
    ],
)
def test_the_health_figure_is_the_worst_of_what_is_known_now(
    run: Run, changes: dict[str, Any], shown: tuple[str, str, str]
) -> None:
    script = """({ healthOf }, { told, live, still, forMs, slow, delay, factor, barrier }) => {
      const status = { latency: { p50_ms: delay, p95_ms: delay, stages: {} } };
      const { grade, word, figure } = healthOf({
        told, live, still, forMs, status, room: { barrier, slow, real_time_factor: factor },
      });
      return [grade, word, figure];
    }"""
    known = {"told": True, "live": True, "still": False, "slow": True, "barrier": "running"}
    known |= {"delay": 60, "factor": 1.0, "forMs": 9000}
    assert run("hud/health-figure.js", script, known | changes) == list(shown)


def test_the_coach_leaves_out_what_the_phone_cannot_do(run: Run) -> None:
    script = """({ Tutorial }) => {
      const tutorial = new Tutorial("touch");
      const tips = [];
      let nowMs = 0;
      let hand = { held: false, position: [0, 0, 0], quaternionWxyz: [1, 0, 0, 0], gripper: 0 };
      const be = (changes, lastsMs = 100) => {
        hand = { ...hand, ...changes };
        for (let ms = 0; ms < lastsMs; ms += 20) tutorial.see(hand, (nowMs += 20));
        tips.push(tutorial.tip);
      };
      be({ held: true }, 600);
      tutorial.leaveOut("turns");
      be({ position: [0, 0.1, 0] });
      be({ position: [0, 0.3, 0] });
      tutorial.leaveOut("turns");
      be({ gripper: 1 });
      return [tips, tutorial.finished];
    }"""
    tips, finished = run("phone/tutorial.js", script)
    assert [tip[:6] for tip in tips] == ["2 of 4", "3 of 3", "3 of 3", ""]
    assert "gripper" in tips[2]
    assert finished
