"""Say in words what is in an export: the data card that goes with it, README.md of a folder, NAME.md beside a file."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from typing import Any

from mart.protocol.recording import Shift
from mart.protocol.vocabulary import OperatorKind
from mart.recorder.export.holders import told_holders
from mart.recorder.export.selection import SOURCES, ExportSelection

_PARTS = ("mart-recorder", "mart-episodes", "mart-render", "mujoco-core")
_FRAMES = (
    "Positions are in metres and in the frame that their name ends in (`_in_base`: the arm's own base, `_in_world`: "
    "the room's, z up); quaternions are wxyz; joints are radians."
)


def lerobot_card(selection: ExportSelection, info: Mapping[str, Any], name: str) -> str:
    """Return the README.md of a LeRobot folder, with what a hub reads at its head."""
    head = [
        "---",
        "license: other  # say under which licence it may be used",
        "task_categories:",
        "- robotics",
        "tags:",
        "- LeRobot",
        "- mart",
        f"- {selection.task.name}",
        "configs:",
        "- config_name: default",
        "  data_files: data/*/*.parquet",
        "---",
        "",
    ]
    rows = [
        (f"`{feature}`", f"{said['dtype']} {said['shape']}", _names(said["names"]))
        for feature, said in info["features"].items()
    ]
    load = [
        "```python",
        "from lerobot.datasets.lerobot_dataset import LeRobotDataset",
        "",
        f'data = LeRobotDataset("mart/{name}", root="{name}")',
        "```",
    ]
    frames, episodes = info["total_frames"], info["total_episodes"]
    return "\n".join(
        [
            *head,
            *_facts(selection, episodes, frames, name),
            *_table("column", "type", "numbers", rows),
            "",
            *load,
            "",
        ]
    )


def robomimic_card(selection: ExportSelection, demonstrations: int, transitions: int, name: str) -> str:
    """Return what stands beside an HDF5 file."""
    rows = [
        (f"`obs/{one.name.replace('/', '_')}`", f"float64 {[*one.shape]}", one.unit or "no unit")
        for one in selection.task.observations
    ]
    rows.append(
        ("`actions`", f"float64 [{7 * len(selection.task.arms)}]", "a step of the tool, then the gripper")
    )
    for camera in selection.cameras:
        size = f"[{camera.height_px}, {camera.width_px}"
        rows.append((f"`obs/{camera.key}_image`", f"uint8 {size}, 3]", "sRGB"))
        if selection.depth:
            rows.append(
                (f"`obs/{camera.key}_depth`", f"float32 {size}, 1]", "metres along the camera's axis")
            )
        if selection.segmentation:
            numbers = "bodies by number: the attribute `bodies` of each demonstration"
            rows.append((f"`obs/{camera.key}_segmentation`", f"int32 {size}, 1]", numbers))
    load = [
        "```python",
        "import h5py",
        "",
        f'with h5py.File("{name}") as file:',
        '    actions = file["data/demo_0/actions"][:]',
        "```",
    ]
    facts = _facts(selection, demonstrations, transitions, name)
    return "\n".join([*facts, *_table("data set", "type", "unit", rows), "", *load, ""])


def _facts(selection: ExportSelection, episodes: int, ticks: int, name: str) -> list[str]:
    task = selection.task
    facts = {
        "task": f"{task.name}: {task.instruction}",
        "arms": ", ".join(f"{arm.name} ({arm.kind.title})" for arm in task.arms),
        "rate": f"{selection.control_hz:g} ticks a second",
        "episodes": f"{episodes}, of {len(selection.episodes)} recorded ones",
        "ticks": f"{ticks} ({ticks / selection.control_hz:.1f} s)",
        "driven by": _driven_by(selection),
        "outcomes": _counts(one.outcome for one in selection.episodes),
        "verdicts": _counts(one.verdict for one in selection.episodes),
        "cameras": _cameras(selection),
        "edits": _edits(selection),
        "sources": json.dumps(SOURCES),
        "holders": json.dumps(dict(enumerate(told_holders(selection.holders, selection.with_names)))),
        "software": ", ".join(f"{part} {version(part)}" for part in _PARTS),
    }
    return [
        f"# {name}",
        "",
        "Made by MART (collaborative teleoperation of arms in one room).",
        "",
        *_table("what", "is", None, list(facts.items())),
        "",
        f"Row t holds what was seen before action t. {_FRAMES}",
        "",
    ]


def _driven_by(selection: ExportSelection) -> str:
    """Count who drove, by arm and episode: each kind that had an arm at any time; names only where asked for."""
    shifts = [
        shift for episode in selection.episodes for shift in _of_episode(episode.shifts, selection.with_names)
    ]
    return _counts(shifts)


def _of_episode(shifts: Iterable[Shift], with_names: bool) -> list[str]:
    said = {
        f"{shift.operator} {shift.name}".strip() if with_names else shift.operator
        for shift in shifts
        if shift.operator != OperatorKind.HOLD
    }
    return sorted(said)


def _cameras(selection: ExportSelection) -> str:
    def told(name: str) -> str:
        if name in selection.captured:
            return "captured by a real camera, the newest picture at each tick, scaled"
        return "drawn anew from the states"

    return "; ".join(f"{camera} ({told(camera.name)})" for camera in selection.cameras) or "none"


def _edits(selection: ExportSelection) -> str:
    edited = sum(bool(episode.edits) for episode in selection.episodes)
    idle = "" if selection.skip_idle_s is None else f"; idle for {selection.skip_idle_s:g} s is left out"
    return f"{edited} episodes were cut, split or had parts skipped{idle}"


def _counts(words: Iterable[str]) -> str:
    return (
        ", ".join(f"{count} {word}" for word, count in sorted(Counter(map(str, words)).items())) or "nobody"
    )


def _names(names: Any) -> str:
    if not names:
        return ""
    return ", ".join(names) if len(names) <= 8 else f"{', '.join(names[:7])}, … ({len(names)} in all)"


def _table(first: str, second: str, third: str | None, rows: Iterable[tuple[str, ...]]) -> list[str]:
    titles = [title for title in (first, second, third) if title is not None]
    lines = [titles, ["---"] * len(titles), *rows]
    return [f"| {' | '.join(_cell(cell) for cell in line)} |" for line in lines]


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
