from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator

import pytest

from mart.runtime.bus.memory import MemoryBus
from mart.web.api.app_state import AppState
from mart.web.clients import running_services
from tests.web.conftest import Enter
from tests.web.trainer import VIDEO, Trainer

pytestmark = pytest.mark.anyio

JOBS = "/api/training/jobs"
POLICIES = "/api/training/policies"
ORDER = {
    "models": ["HBC", "r-HBC"],
    "tasks": ["two_arm_multi_cube_lifting"],
    "data": "episodes",
    "preset": "fast",
}


@pytest.fixture
def trainer(app_state: AppState, bus: MemoryBus) -> Iterator[Trainer]:
    with contextlib.closing(Trainer(bus)) as trainer:
        yield trainer


async def test_without_a_trainer_it_says_how_to_start_one(enter: Enter) -> None:
    ana = await enter("Ana")
    assert (await ana.get("/api/training/choices")).json() == {"choices": None}
    assert (await ana.get(POLICIES)).json() == {"policies": []}
    answer = await ana.get(JOBS)
    assert answer.status_code == 503
    assert "`mart trainer`" in answer.json()["error"]["message"]


@pytest.mark.parametrize("path", ["choices", "jobs", "jobs/job-0001", "jobs/job-0001/log", "policies"])
async def test_only_who_has_joined_sees_what_is_trained(enter: Enter, trainer: Trainer, path: str) -> None:
    assert (await (await enter()).get(f"/api/training/{path}")).status_code == 401


async def test_what_can_be_ordered_comes_with_defaults(enter: Enter, trainer: Trainer) -> None:
    choices = (await (await enter("Ana")).get("/api/training/choices")).json()["choices"]
    assert choices["order"]["model"] == "r-HBC"
    assert {"name": "d-HBC", "planner": "per-arm", "actor": "per-arm", "residual": "none"}.items() <= choices[
        "models"
    ][2].items()
    told = [(one["path"], one["name"], one["episodes"], one["left_out"]) for one in choices["data"]]
    assert told[:2] == [("episodes", "", 64, 0), ("episodes", "cubes-good", 58, 2)]
    assert choices["data"][0]["tasks"] == ["two_arm_multi_cube_lifting"]


async def test_an_order_is_one_job_a_model(enter: Enter, trainer: Trainer) -> None:
    answer = await (await enter("Ana")).post(JOBS, json=ORDER | {"seeds": [0, 1], "evaluation_episodes": 5})
    assert [(job["order"]["model"], job["state"]) for job in answer.json()["jobs"]] == [
        ("HBC", "queued"),
        ("r-HBC", "queued"),
    ]
    order = trainer.asked[-1].submit.order
    assert (list(order.seeds), order.evaluation_episodes, order.preset) == ([0, 1], 5, "fast")


@pytest.mark.parametrize(
    "bad",
    [
        {"models": []},
        {"models": ["HBC"] * 17},
        {"seeds": list(range(65))},
        {"seeds": [-1]},
        {"evaluation_episodes": -1},
        {"tasks": "x"},
    ],
)
async def test_an_order_out_of_bounds_is_refused(
    enter: Enter, trainer: Trainer, bad: dict[str, object]
) -> None:
    assert (await (await enter("Ana")).post(JOBS, json=ORDER | bad)).status_code == 400
    assert trainer.asked == []


async def test_a_run_is_shown_with_curves_and_rollouts(enter: Enter, trainer: Trainer) -> None:
    details = (await (await enter("Ana")).get(f"{JOBS}/job-0002")).json()["details"]
    assert details["job"]["state"] == "done"
    assert [curve["name"] for curve in details["curves"]] == ["loss/actor", "loss/planner"]
    assert details["evaluations"][-1]["purpose"] == "score"
    assert (details["learned"]["dataset"], details["learned"]["episodes"]) == ("cubes-good", 57)
    assert details["evaluations"][-1]["rollouts"][0]["outcome"] == "horizon"


async def test_a_run_is_cancelled_and_tried_again(enter: Enter, trainer: Trainer) -> None:
    ana = await enter("Ana")
    for action, state in (("cancel", "cancelled"), ("retry", "queued")):
        (job,) = (await ana.post(f"{JOBS}/job-0003", json={"action": action})).json()["jobs"]
        assert (job["id"], job["state"]) == ("job-0003", state)
    assert (await ana.post(f"{JOBS}/job-0003", json={"action": "explode"})).status_code == 400
    assert "job-0003" in (await ana.get(f"{JOBS}/job-0003/log")).json()["log"]


async def test_what_the_trainer_reports_is_told_with_its_status(enter: Enter, trainer: Trainer) -> None:
    answer = await (await enter("Ana")).get(f"{JOBS}/job-9")
    assert answer.status_code == 404
    assert answer.json()["error"]["code"] == "NotFound"


async def test_a_checkpoint_is_promoted_once_under_a_name(enter: Enter, trainer: Trainer) -> None:
    ana = await enter("Ana")
    promotion = {"job": "job-0002", "checkpoint": "checkpoints/600/seed-0", "name": "lifter"}
    (policy,) = (await ana.post(POLICIES, json=promotion)).json()["policies"]
    assert (policy["name"], policy["arms"], policy["joint"]) == ("lifter", ["arm0", "arm1"], False)
    assert (await ana.post(POLICIES, json=promotion)).status_code == 409
    assert [one["name"] for one in (await ana.get(POLICIES)).json()["policies"]] == ["lifter"]
    assert (await ana.get(f"{POLICIES}?task=other")).json()["policies"] == []
    assert [one["name"] for one in (await ana.delete(f"{POLICIES}/lifter")).json()["policies"]] == ["lifter"]


async def test_nothing_is_trained_or_promoted_from_another_site(enter: Enter, trainer: Trainer) -> None:
    ana = await enter("Ana")
    foreign = {"Origin": "https://evil.example"}
    assert (await ana.post(JOBS, json=ORDER, headers=foreign)).status_code == 403
    assert (await ana.post(POLICIES, json={}, headers=foreign)).status_code == 403
    assert (await ana.delete(f"{POLICIES}/lifter", headers=foreign)).status_code == 403
    assert trainer.asked == []


async def test_a_video_comes_in_pieces_once_it_is_rendered(enter: Enter, trainer: Trainer) -> None:
    ana = await enter("Ana")
    path = f"{JOBS}/job-0002/videos/seed-7"
    assert (await ana.get(path)).status_code == 202
    answer = await ana.get(path)
    assert (answer.status_code, answer.headers["content-type"]) == (200, "video/mp4")
    assert answer.content == VIDEO


async def test_a_trainer_that_went_away_is_told(
    enter: Enter, trainer: Trainer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running_services, "AWAY_S", 0.0)
    ana = await enter("Ana")
    trainer.close()
    await asyncio.sleep(0)
    assert (await ana.get(JOBS)).status_code == 503
