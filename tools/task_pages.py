"""Writes docs/tasks.md from the catalogue, and draws every task from every viewpoint: `make task-pages`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from mart.protocol.tasks import SHARED_VIEWPOINT, Task, arm_counts, get_task, task_names
from mart.render import Renderer
from mart.sim.envs.registration import gymnasium_id
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World

DOCS = Path(__file__).resolve().parents[1] / "docs"
SHEET = "images/tasks.jpg"
PICTURES = DOCS.parent / "services/web/src/mart/web/static/tasks"  # of the lobby

_VIEW_PX = (480, 360)
_PICTURE_PX = (384, 288)
_MARGIN_PX, _TITLE_PX = 12, 40
_PAPER, _INK, _SOFT_INK = "#FFFFFF", "#1F2428", "#6A737D"
_SEED = 4
_MIDDLE = 0.55


def page() -> str:
    """The text of docs/tasks.md."""
    tasks = [get_task(name) for name in task_names()]
    return "\n".join([*_overview(tasks), *(line for task in tasks for line in _section(task))])


def sheet() -> Image.Image:
    """One row for each task, one picture for each viewpoint, in the middle of what experts do."""
    rows = [_row(task) for task in map(get_task, task_names())]
    whole = Image.new("RGB", (max(row.width for row in rows), sum(row.height for row in rows)), _PAPER)
    top = 0
    for row in rows:
        whole.paste(row, (0, top))
        top += row.height
    return whole


def pictures(whole: Image.Image) -> Iterator[tuple[Path, Image.Image]]:
    """Each task's shared view, out of the sheet."""
    width, height = _VIEW_PX
    row_px = whole.height // len(task_names())
    for index, name in enumerate(task_names()):
        top = index * row_px + _TITLE_PX + _MARGIN_PX
        view = whole.crop((_MARGIN_PX, top, _MARGIN_PX + width, top + height))
        yield PICTURES / f"{name}.jpg", view.resize(_PICTURE_PX, Image.Resampling.LANCZOS)


def _overview(tasks: list[Task]) -> Iterator[str]:
    yield "# What tasks are there?"
    yield ""
    yield "Made by `make task-pages` from the catalogue and the scenes. A subtask in *italics* takes more than one"
    yield "arm at the same time. How to add one: [how-to-add-a-task.md](how-to-add-a-task.md)."
    yield "How to use a task from your own code: [how-to-use-the-environments.md](how-to-use-the-environments.md)."
    yield ""
    yield f"![Every task from every viewpoint: the shared one, and one for each seat]({SHEET})"
    yield ""
    yield "| task | arms | what everyone is told | subtasks | success holds | time limit |"
    yield "|---|---|---|---|---|---|"
    for task in tasks:
        counts = ", ".join(map(str, arm_counts(task.name)))
        subtasks = "; ".join(f"*{s.title}*" if s.coordinated else s.title for s in task.subtasks)
        holds_s = task.success_hold_ticks / 20
        yield (
            f"| [{task.title}](#{task.name}) | {counts} | {task.instruction} | {subtasks} | {holds_s:g} s | "
            f"{task.time_limit_s:g} s |"
        )


def _section(task: Task) -> Iterator[str]:
    yield ""
    yield f"## {task.name}"
    yield ""
    yield f"{task.title}, with {len(task.arms)} arms. In Gymnasium: `{gymnasium_id(task.name)}`."
    yield ""
    yield "| observation | shape | unit | seen by |"
    yield "|---|---|---|---|"
    for one in task.observations:
        yield f"| `{one.name}` | {'×'.join(map(str, one.shape))} | {one.unit} | {', '.join(one.arms)} |"


def _row(task: Task) -> Image.Image:
    width, height = _VIEW_PX
    world = _in_the_middle(task)
    step = width + _MARGIN_PX
    size = (_MARGIN_PX + step * len(task.viewpoints), _TITLE_PX + height + 2 * _MARGIN_PX)
    row = Image.new("RGB", size, _PAPER)
    draw = ImageDraw.Draw(row)
    draw.text((_MARGIN_PX, _MARGIN_PX), task.title, _INK, ImageFont.load_default(22))
    for index, viewpoint in enumerate((SHARED_VIEWPOINT, *task.arm_names)):
        left = _MARGIN_PX + index * step
        row.paste(_view(world, viewpoint), (left, _TITLE_PX + _MARGIN_PX))
        draw.text((left + width, _TITLE_PX), viewpoint, _SOFT_INK, ImageFont.load_default(16), anchor="rs")
    return row


def _view(world: World, viewpoint: str) -> Image.Image:
    """Drawn at twice the size and made smaller, so that edges are smooth."""
    width, height = _VIEW_PX
    with closing(Renderer(world.model, viewpoint, 2 * width, 2 * height)) as renderer:
        large = Image.fromarray(renderer.draw(world.integration_state()))
    return large.resize(_VIEW_PX, Image.Resampling.LANCZOS)


def _in_the_middle(task: Task) -> World:
    """The world when scripts have done about half."""
    world = World.build(task.name)
    run_experts(world, _SEED)
    run_experts(world, _SEED, until_s=_MIDDLE * world.sim_time_s)
    return world


if __name__ == "__main__":
    (DOCS / "tasks.md").write_text(page() + "\n")
    drawn = sheet()
    drawn.save(DOCS / SHEET, quality=88, optimize=True)
    PICTURES.mkdir(exist_ok=True)
    for path, picture in pictures(drawn):
        picture.save(path, quality=82, optimize=True)
