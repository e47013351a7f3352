"""What pages do for an arm without fingers."""

from __future__ import annotations

from tests.browser.pages.conftest import Run
from tests.browser.pages.test_status_bar import LIVE, room, seat


def test_the_coach_does_not_ask_an_arm_without_fingers_to_grip(run: Run) -> None:
    script = """({ Tutorial }) => {
      const tutorial = new Tutorial("xr");
      tutorial.leaveOut("grips");
      tutorial.leaveOut("turns");
      return tutorial.tip;
    }"""
    assert run("phone/tutorial.js", script).startswith("1 of 2: ")


def test_the_phone_greys_the_bar_of_an_arm_without_fingers(run: Run) -> None:
    script = """({ GripperBar }) => {
      const node = document.createElement("div");
      node.innerHTML = "<span class=fill></span><span class=name>Gripper</span>";
      const bar = new GripperBar(node);
      return [false, true].map((hasFingers) => {
        bar.enable(hasFingers);
        return [node.getAttribute("aria-disabled"), node.textContent];
      });
    }"""
    assert run("phone/controls.js", script) == [["true", "No gripper"], ["false", "Gripper"]]


def test_nobody_is_told_of_a_gripper_that_is_not_there(run: Run) -> None:
    script = """({ statusBarView }, known) => [false, true].map(
      (fingerless) => statusBarView({ ...known, fingerless }).hint)"""
    mine = seat(mine=True)
    known = {"room": room(mine), "seat": mine, "link": LIVE, "isNew": True}
    usual, without = run("hud/status-bar-view.js", script, known)
    assert usual == f"{without} G works the gripper."
