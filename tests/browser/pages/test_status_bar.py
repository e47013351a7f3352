"""What the status bar says and offers in every state: the pages' one clear next action."""

from __future__ import annotations

from typing import Any

import pytest

from tests.browser.pages.conftest import Run

LIVE = {"state": "live", "problem": "", "role": "browser"}


def seat(arm: str = "arm0", operator: str = "human", name: str = "Ana", **more: Any) -> dict[str, Any]:
    return {"arm": arm, "operator": operator, "name": name, "ready": False, "mine": False, **more}


def room(*seats: dict[str, Any], phase: str = "practice", **episode: Any) -> dict[str, Any]:
    return {
        "seats": list(seats),
        "stale": False,
        "barrier": "running",
        "instruction": "Lift.",
        "time_limit_s": 15,
        "episode": {"phase": phase, "elapsed_s": 0, "remaining_s": 0, "outcome": "", "reason": "", **episode},
    }


def view(run: Run, the_room: dict[str, Any] | None, **more: Any) -> dict[str, Any]:
    known = {"room": the_room, "seat": the_room and the_room["seats"][0], "link": LIVE, "saved": None, **more}
    shown: dict[str, Any] = run(
        "hud/status-bar-view.js", "({ statusBarView }, known) => statusBarView(known)", known
    )
    shown["actions"] = [action["command"] for action in shown["actions"]]
    return shown


MINE = seat(mine=True)
RELIEVING = seat(mine=True, relieved="lifter")
OUTCOMES = ["success", "failure", "discard"]
READY = seat(mine=True, ready=True)
SAVED = {"path": "episodes/x.mcap", "verified": True, "verdict": "", "size_bytes": 2_345_678}


@pytest.mark.parametrize(
    ("the_room", "label", "actions"),
    [
        (room(MINE), "Practice", ["ready"]),
        (room(READY, seat("arm1", name="Ben")), "Ready", ["unready"]),
        (room(MINE, phase="countdown", remaining_s=2.2), "Starts in", []),
        (room(MINE, phase="recording", elapsed_s=42.9), "Recording", OUTCOMES),
        (room(MINE, phase="ended", outcome="failure", reason="time is up"), "Failed", []),
        (room(seat(operator="hold", name="")), "Free seat", ["take"]),
        (room(seat(operator="script", name="")), "Practice", ["take", "ready"]),
        (room(seat(operator="policy", name="lifter"), phase="recording"), "Recording", ["take", *OUTCOMES]),
        (room(seat(operator="policy", name="lifter"), seat("arm1")), "Practice", ["take"]),
        (room(RELIEVING), "Practice", ["ready", "back"]),
        (room(RELIEVING, phase="recording"), "Recording", [*OUTCOMES, "back"]),
        (room(seat(name="Ben")), "Watching", ["lobby"]),
        (room(seat(operator="hold", name=""), seat("arm1", mine=True)), "Watching", ["lobby"]),
        (None, "No such seat", ["lobby"]),
        (room(MINE) | {"stale": True}, "The room is silent", []),
        (room(MINE) | {"barrier": "stopped"}, "Stopped", []),
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
    assert shown["actions"] == ["ready"]
    assert ("you may go on" in shown["detail"]) == ("recorded" in words)


def test_people_are_named_when_they_wait_for_each_other(run: Run) -> None:
    assert "Waiting for Ben" in view(run, room(READY, seat("arm1", name="Ben")))["detail"]
    assert "Ben is ready" in view(run, room(MINE, seat("arm1", name="Ben", ready=True)))["detail"]


@pytest.mark.parametrize(
    ("outcome", "label", "words"),
    [
        ("success", "Success", "Saved and verified: episodes/x.mcap (2.3 MB)"),
        ("unspecified", "Interrupted", "Saved and verified: episodes/x.mcap (2.3 MB)"),
        ("discarded", "Discarded", "Kept, and labelled discarded: episodes/x.mcap (2.3 MB)"),
    ],
)
def test_after_an_episode_the_file_is_named(run: Run, outcome: str, label: str, words: str) -> None:
    shown = view(run, room(MINE), saved=SAVED | {"outcome": outcome})
    assert (shown["label"], shown["detail"], shown["actions"]) == (label, words, ["ready"])


def test_a_lost_connection_is_said(run: Run) -> None:
    lost = view(run, room(MINE), link=LIVE | {"state": "silent"})
    assert lost["label"] == "Connection lost"
    refused = view(run, room(MINE), link=LIVE | {"state": "connecting", "problem": "No gateway is running."})
    assert refused["detail"] == "No gateway is running."


def test_a_replaced_page_waits_to_be_asked(run: Run) -> None:
    shown = view(run, room(MINE), link=LIVE | {"state": "replaced"})
    assert (shown["label"], shown["actions"]) == ("Driven elsewhere", ["here"])


def test_a_newcomer_is_told_the_first_moves(run: Run) -> None:
    assert "Hold space" in view(run, room(MINE), isNew=True)["detail"]
    assert "Nothing is recorded" in view(run, room(MINE), isNew=False)["detail"]
