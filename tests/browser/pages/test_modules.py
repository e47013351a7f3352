"""The pages' own modules, run in a real Chromium: bytes, codes and state machines that need no world."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mart.episodes.labels import Label, LabelKind
from tests.browser.pages.conftest import Run

GOLDEN = json.loads(Path("tests/teleop_gateway/golden/phone_frame.json").read_text())["cases"]


@pytest.mark.parametrize("case", GOLDEN, ids=lambda case: case["name"])
def test_phone_frames_have_the_golden_bytes(run: Run, case: dict[str, Any]) -> None:
    frame = case["frame"]
    fields = {
        "seatEpoch": frame["seat_epoch"],
        "sequence": frame["sequence"],
        "seenTick": frame["seen_tick"],
        "sentUs": frame["sent_us"],
        "position": frame["position"],
        "quaternionWxyz": frame["quaternion_wxyz"],
        "gripper": frame["gripper"],
        "flags": frame["flags"],
    }
    encoded = run(
        "drive/frame.js", "({ encodeFrame }, frame) => Array.from(new Uint8Array(encodeFrame(frame)))", fields
    )
    assert bytes(encoded).hex() == case["hex"]


def tick_luma(tick: int) -> list[int]:
    """The 40 squares of docs/protocol.md, "Tick code in the picture"."""
    code = tick.to_bytes(4, "big")
    check = code[0] ^ code[1] ^ code[2] ^ code[3] ^ 0xA5
    bits = f"{tick:032b}{check:08b}"
    return [235 if bit == "1" else 16 for bit in bits]


DECODE = "({ decodeTick }, luma) => decodeTick(luma)"


@pytest.mark.parametrize("tick", [0, 1, 255, 98765, 2**31, 2**32 - 1])
def test_a_tick_is_read_out_of_its_squares(run: Run, tick: int) -> None:
    assert run("link/tickcode.js", DECODE, tick_luma(tick)) == tick


@pytest.mark.parametrize("square", [0, 17, 31, 32, 39])
def test_a_torn_tick_code_is_not_read(run: Run, square: int) -> None:
    luma = tick_luma(4711)
    luma[square] = 255 - luma[square]
    assert run("link/tickcode.js", DECODE, luma) is None


MOVE = """({ VirtualPhone }, { engaged, move, drag, seconds }) => {
  const hand = new VirtualPhone();
  const steps = [];
  hand.drag(drag);
  for (let at = 0; at < seconds; at += 0.016) {
    const before = hand.position;
    hand.step({ engaged, move, turn: [0, 1, 0] }, 0.016);
    steps.push(Math.hypot(...hand.position.map((value, index) => value - before[index])));
  }
  return { position: hand.position, quaternion: hand.quaternionWxyz, longest: Math.max(...steps) };
}"""


def moved(
    run: Run, engaged: bool, move: list[float], drag: list[float], seconds: float = 1.0
) -> dict[str, Any]:
    argument = {"engaged": engaged, "move": move, "drag": drag, "seconds": seconds}
    hand: dict[str, Any] = run("drive/virtual-phone.js", MOVE, argument)
    return hand


def test_keys_move_the_hand_at_a_steady_pace(run: Run) -> None:
    hand = moved(run, True, [0, 0, -1], [0, 0, 0])
    assert hand["position"][:2] == pytest.approx([0, 0])
    assert hand["position"][2] == pytest.approx(-0.25, rel=0.1)
    assert sum(value**2 for value in hand["quaternion"]) == pytest.approx(1)


def test_two_keys_are_not_faster_than_one(run: Run) -> None:
    assert moved(run, True, [1, 1, 0], [0, 0, 0])["longest"] <= 0.25 * 0.016 * 1.001


def test_a_drag_is_followed_whole_but_never_in_a_jump(run: Run) -> None:
    hand = moved(run, True, [0, 0, 0], [0.4, -0.2, 0])
    assert hand["position"] == pytest.approx([0.4, -0.2, 0])
    assert hand["longest"] <= 0.8 * 0.016 * 1.001


def test_a_drag_of_one_finger_two_or_with_shift_reaches_every_direction(run: Run) -> None:
    def drag(fingers: int, turns: bool) -> Any:
        asked = {"x": 0.1, "y": 0.2, "fingers": fingers, "turns": turns}
        return run("drive/gestures.js", "({ dragOf }, drag) => Object.values(dragOf(drag)).flat()", asked)

    assert drag(1, False) == pytest.approx([0.14, -0.28, 0, 0, 0, 0])
    assert drag(2, False) == pytest.approx([0, 0, 0.14, 0, 0.25, 0])
    assert drag(1, True) == pytest.approx([0, 0, 0, 1.0, 0.5, 0])


def test_an_open_clutch_moves_nothing(run: Run) -> None:
    hand = moved(run, False, [1, 1, 1], [0.4, 0, 0])
    assert (hand["position"], hand["quaternion"]) == ([0, 0, 0], [1, 0, 0, 0])


@pytest.mark.parametrize(
    ("angles", "up"),
    [([0, 90, 0], [0, 1, 0]), ([123, 90, 0], [0, 1, 0]), ([0, 0, 0], [0, 0, -1])],
    ids=["upright", "upright, turned", "flat on the table"],
)
def test_the_orientation_sensor_is_read_into_the_session_frame(
    run: Run, angles: list[float], up: list[float]
) -> None:
    """Where the phone's upper edge points."""
    script = """async ({ fromDeviceAngles }, angles) => {
      const { rotate } = await import("/static/js/drive/quaternion.js");
      return rotate(fromDeviceAngles(...angles), [0, 1, 0]);
    }"""
    assert run("phone/orientation.js", script, angles) == pytest.approx(up, abs=1e-9)


def test_a_hand_knows_how_far_it_has_moved_since_a_frame_of_the_same_press(run: Run) -> None:
    script = """({ SentHands }) => {
      const sent = new SentHands();
      sent.add(1, [9, 9, 9], true);
      sent.add(2, [0, 0, 0], false);
      for (let number = 3; number <= 300; number += 1) sent.add(number, [number / 100, 0, -number / 50], true);
      return [1, 2, 3, 200, 300, 301].map((number) => sent.movedSince(number));
    }"""
    first, open_clutch, old, then, newest, never = run("drive/sent-hands.js", script)
    assert [first, open_clutch, old, never] == [None] * 4
    assert then == pytest.approx([1, 0, -2])
    assert newest == [0, 0, 0]


def test_the_fastest_ping_tells_the_clock(run: Run) -> None:
    script = """({ ClockOffset }) => {
      const clock = new ClockOffset();
      const pings = [[1000, 400], [2000, 10], [3000, 200]]; // sent, round trip; the gateway is 7 s ahead
      return pings.map(([sent, trip]) =>
        clock.pong({ t_us: sent, gateway_ns: 7e9 + (sent + trip * 0.9) * 1000 }, sent + trip));
    }"""
    offsets = run("link/clock-offset.js", script)
    assert offsets == pytest.approx([7e9 + 160_000, 7e9 + 4_000, 7e9 + 4_000])


def test_h264_without_reencoding_is_preferred_then_vp8(run: Run) -> None:
    codecs = [
        {"mimeType": "video/rtx"},
        {"mimeType": "video/VP8"},
        {"mimeType": "video/H264", "sdpFmtpLine": "packetization-mode=0;profile-level-id=42e01f"},
        {"mimeType": "video/H264", "sdpFmtpLine": "packetization-mode=1;profile-level-id=42001f"},
        {"mimeType": "video/H264", "sdpFmtpLine": "packetization-mode=1;profile-level-id=42e01f"},
        {"mimeType": "video/H264", "sdpFmtpLine": "packetization-mode=1;profile-level-id=640034"},
    ]
    ordered = run("link/peer.js", "({ h264First }, codecs) => h264First(codecs)", codecs)
    assert ordered == [codecs[4], codecs[3], codecs[1], codecs[0], codecs[2], codecs[5]]


def test_the_coach_moves_on_when_a_step_was_done(run: Run) -> None:
    script = """({ Tutorial }) => {
      const tutorial = new Tutorial("xr");
      const still = { held: false, position: [0, 1, 0], quaternionWxyz: [1, 0, 0, 0], gripper: 0 };
      const held = { ...still, held: true };
      const tips = [tutorial.tip];
      const see = (hand, atMs) => tutorial.see(hand, atMs) && tips.push(tutorial.tip);
      see(still, 0); see(held, 100); see(held, 400); see(still, 450); see(held, 500); see(held, 1000);
      see(held, 1100); see({ ...held, position: [0, 1.06, 0] }, 1200);
      see(held, 1300); see({ ...held, quaternionWxyz: [Math.cos(0.2), 0, Math.sin(0.2), 0] }, 1400);
      see({ ...still, gripper: 0.9 }, 1500);
      return { tips, finished: tutorial.finished };
    }"""
    coached = run("phone/tutorial.js", script)
    assert [tip[:1] for tip in coached["tips"]] == ["1", "2", "3", "4", ""]
    assert coached["finished"]


REPEAT = """async ({ repeating }) => {
  const due = new Map();
  const { setTimeout, clearTimeout } = globalThis;
  globalThis.setTimeout = (deed, afterMs) => due.set(due.size + 1, afterMs).size;
  globalThis.clearTimeout = (timer) => due.delete(timer);
  try {
    const again = repeating(() => Promise.resolve(), 200);
    await Promise.all([again(), again(), again()]);
    return [...due.values()];
  } finally {
    Object.assign(globalThis, { setTimeout, clearTimeout });
  }
}"""


def test_what_is_asked_for_thrice_is_repeated_once(run: Run) -> None:
    """A page asks meanwhile, too: when it is looked at again, and after every press."""
    assert run("repeating.js", REPEAT) == [200]


def test_a_hand_feels_what_is_new_and_only_while_it_drives(run: Run) -> None:
    script = """({ vibrationsFor }, said) => said.map((one, at) => vibrationsFor(one, said[at - 1] ?? null, "arm0"))"""
    said = [
        {"holding": holding, "input": source, "waiting": [{"arm": arm} for arm in late]}
        for holding, source, late in (
            (True, "phone", []),  # held already when it came
            (False, "phone", ["arm1"]),
            (True, "phone", ["arm0"]),
            (True, "phone", ["arm0"]),
            (False, "keyboard", []),
            (True, "keyboard", []),
        )
    ]
    assert run("phone/feedback.js", script, said) == [[], [], ["late", "grasped"], [], [], []]


def test_whatever_is_typed_becomes_a_name_that_a_data_set_may_have(run: Run) -> None:
    typed = ["Cubes, good", "  -_a", "Ünder 2", "x" * 99, "ok_1-2", "!?"]
    names = run("names.js", "({ nameFrom }, typed) => typed.map((text) => nameFrom(text))", typed)
    assert names == ["cubes-good", "a", "nder-2", "x" * 64, "ok_1-2", ""]
    assert run("names.js", "({ finalName }) => finalName('My Set!')") == "my-set"
    for name in filter(None, names):
        Label("a", LabelKind.JOIN, name, 1)


@pytest.mark.parametrize(
    ("chosen", "tasks", "text"),
    [
        ({}, 1, "All that succeeded; tick some to choose others."),
        ({}, 2, "Choose one task above, or tick episodes."),
        ({"task": "two_arm_multi_cube_lifting"}, 2, "All that succeeded; tick some to choose others."),
        ({"task": "two_arm_multi_cube_lifting", "outcome": "failure"}, 2, "All that are shown; tick"),
    ],
)
def test_who_ticks_nothing_takes_what_succeeded_of_one_task(
    run: Run, chosen: dict[str, str], tasks: int, text: str
) -> None:
    told = run(
        "episodes/formatting.js",
        "({ allText }, { chosen, tasks }) => allText(chosen, tasks)",
        {"chosen": chosen, "tasks": tasks},
    )
    assert told.startswith(text)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        (
            "Ana gave no command for 30 s: arm2 is free.",
            "Ana gave no command for 30 s: the green arm is free.",
        ),
        ("arm0 waits.", "The blue arm waits."),
        ("of three_arm_lift_wiping, two_arm_nothing", "Of “Lift and wipe”, two_arm_nothing"),
        (
            "2026/room-1-0001-two_arm_multi_cube_lifting.mcap",
            "2026/room-1-0001-two_arm_multi_cube_lifting.mcap",
        ),
        ("See arm0/shadow.", "See arm0/shadow."),
    ],
)
def test_people_read_of_arms_and_tasks_by_the_names_that_they_know(run: Run, text: str, plain: str) -> None:
    assert run("plain-words.js", "({ inPlainWords }, text) => inPlainWords(text)", text) == plain


def test_whose_word_an_outcome_is_stands_beside_it(run: Run) -> None:
    ended = {
        "ended_by": "operator",
        "ended_by_name": "Ana",
        "subtasks_done": 0,
        "subtasks": 3,
        "outcome_by": "",
    }
    told = run(
        "episodes/formatting.js",
        "({ saidText }, episodes) => episodes.map(saidText)",
        [ended, ended | {"ended_by": "task"}, ended | {"outcome_by": "Rita"}, ended | {"subtasks": None}],
    )
    assert told == ["said by Ana, 0 of 3 steps done", "", "labelled by Rita", "said by Ana"]


def test_what_is_said_of_an_episode_can_be_taken_back(run: Run) -> None:
    before = {"outcome": "success", "dropped": False, "note": ""}
    script = (
        "({ undoing, labelledText }, { before, now }) => [undoing(before, now), labelledText(before, now)]"
    )

    def told(was: dict[str, Any], now: dict[str, Any]) -> Any:
        return run("episodes/formatting.js", script, {"before": was, "now": now})

    failed = before | {"outcome": "failure"}
    assert told(before, failed) == [{"outcome": "success"}, "Saved: Failed. It was: Success."]
    assert told(before, before | {"dropped": True}) == [{"dropped": False}, "Saved: left out of data sets."]
    assert told(before, before | {"note": "x"}) == [{"note": ""}, "Saved: the note."]
    assert told(before | {"outcome": "unspecified"}, failed)[0] is None
