"""LeRobot's own trainer makes a policy of exported episodes; it is judged, and drives an arm beside a person."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

from mart.episodes import list_episodes
from mart.operators import Operator, OperatorKind, SeatView, ToolTarget, drive_seats
from mart.protocol.messages import OPERATOR_POLICY
from tests.lerobot.environment import LeRobotPlace
from tests.support.processes import running_router, running_service, started
from tests.system.room_client import RoomClient

ROOM, TASK = "room-1", "two_arm_multi_cube_lifting"
TIME_LIMIT_S = 4.0
_POLICIES = {
    "act": (
        "--policy.chunk_size=5",
        "--policy.n_action_steps=5",
        "--policy.dim_model=64",
        "--policy.n_heads=4",
        "--policy.dim_feedforward=128",
        "--policy.n_encoder_layers=1",
        "--policy.latent_dim=8",
        "--policy.n_vae_encoder_layers=1",
        "--policy.pretrained_backbone_weights=null",
    ),
    "diffusion": (
        "--policy.n_obs_steps=2",
        "--policy.horizon=8",
        "--policy.n_action_steps=4",
        "--policy.down_dims=[32,64]",
        "--policy.diffusion_step_embed_dim=32",
        "--policy.spatial_softmax_num_keypoints=8",
        "--policy.crop_shape=[56,56]",
        "--policy.num_train_timesteps=20",
        "--policy.num_inference_steps=2",
        "--policy.pretrained_backbone_weights=null",
    ),
}


class Riser(Operator):
    """A person who raises an empty hand."""

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        up_m = 0.01 if view.poses_tool_in_base["arm0"].position[2] < 0.4 else 0.0
        return {"arm0": view.step("arm0", (0, 0, up_m))}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where episodes are recorded."""
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="module")
def endpoint(data: Path) -> Iterator[str]:
    """A router, a replica and a room whose episodes are recorded."""
    sim = ["sim", "--room", ROOM, "--seed", "1", "--control-hz", "20", "--time-limit-s", str(TIME_LIMIT_S)]
    with (
        running_router() as endpoint,
        running_service(["replica", "--name", "replica-1"], endpoint, data, kind="replica", id="replica-1"),
        running_service(["recorder"], endpoint, data, kind="recorder", id="recorder-1"),
        running_service(sim, endpoint, data, kind="sim", id=ROOM),
    ):
        yield endpoint


@pytest.fixture(scope="module")
def place(endpoint: str, tmp_path_factory: pytest.TempPathFactory) -> LeRobotPlace:
    return LeRobotPlace(tmp_path_factory.mktemp("lerobot"), endpoint)


@pytest.fixture(scope="module")
def data_set(place: LeRobotPlace, endpoint: str) -> Path:
    """A few exported episodes, with a picture."""
    episodes, out = place.folder / "episodes", place.folder / "data_set"
    collect = ["collect", "--task", TASK, "--episodes", "3", "--lockstep", "--out", str(episodes)]
    export = ["episodes", "export", str(episodes), "--format", "lerobot", "--out", str(out)]
    for command in (collect, [*export, "--camera", "front:64x64"]):
        with started(command, endpoint, place.folder) as running:
            assert running.process.wait(120.0) == 0, running.log()
    return out


@pytest.fixture(scope="module", params=_POLICIES)
def kind(request: pytest.FixtureRequest) -> str:
    """The kind of policy, as LeRobot names it."""
    found: str = request.param
    return found


@pytest.fixture(scope="module")
def checkpoint(place: LeRobotPlace, data_set: Path, kind: str) -> Path:
    """A small policy of this kind, trained for a few steps."""
    run = place.folder / f"run-{kind}"
    done = place.run(
        "lerobot-train",
        "--dataset.repo_id=mart/cubes",
        f"--dataset.root={data_set}",
        f"--policy.type={kind}",
        "--policy.device=cpu",
        "--policy.push_to_hub=false",
        *_POLICIES[kind],
        "--steps=10",
        "--batch_size=4",
        "--num_workers=0",
        "--save_freq=10",
        f"--output_dir={run}",
        "--job_name=cubes",
    )
    assert done.returncode == 0, done.stdout
    return run / "checkpoints" / "last" / "pretrained_model"


def test_it_is_judged_in_the_worlds_of_every_policy(place: LeRobotPlace, checkpoint: Path, kind: str) -> None:
    judge = ("mart", "eval", "--checkpoint", checkpoint, "--episodes", "2", "--time-limit", "1")
    done = place.run(*judge, "--replicas", "replica-1", "--json")
    assert done.returncode == 0, done.stdout
    (said,) = json.loads(done.stdout.splitlines()[-1])["evaluations"]
    assert (said["model"], said["task"], len(said["played"])) == (f"LeRobot's {kind}", TASK, 2)


def test_it_drives_an_arm_beside_a_person_and_is_recorded(
    place: LeRobotPlace, checkpoint: Path, kind: str, endpoint: str, data: Path
) -> None:
    operate = ["mart", "operate", "--checkpoint", str(checkpoint), "--arm", "arm1", "--name", kind]
    with RoomClient(endpoint, ROOM) as client, place.started(operate) as log:
        client.statuses.wait_for(lambda status: status.seats[1].operator == OPERATOR_POLICY, 120.0)
        client.states.wait_for(lambda state: state.arms[1].source == OPERATOR_POLICY, 60.0)
        outcomes = drive_seats(
            Riser(), ROOM, ["arm0"], name="Ana", kind=OperatorKind.HUMAN, episodes=1, router=endpoint
        )
        saved = client.events.wait_for(lambda event: event.HasField("episode_saved"), 60.0)
        assert len(outcomes) == 1, log.read_text()
    (recorded,) = list_episodes(data / saved.episode_saved.path)
    assert recorded.operators == {"arm0": "human Ana", "arm1": f"policy {kind}"}
    way = recorded.open().arrays()
    assert (way.sources[:, 1] == OPERATOR_POLICY).all()
    assert np.abs(way.actions[:, 1, :6]).max() > 0.01
