"""What the phone does for an arm without fingers."""

from __future__ import annotations

from tests.browser.pages.conftest import Run


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
