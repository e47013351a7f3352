"""LeRobot's own commands against a running room: a seat is driven and recorded, an arm leads, and what cannot be."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from mart.operators import Operator, SeatView, ToolTarget, drive_seats
from mart.protocol.messages import OPERATOR_HOLD, OPERATOR_POLICY
from tests.lerobot.environment import LeRobotPlace
from tests.support.processes import running_router, running_service
from tests.system.room_client import RoomClient

ROOM = "room-1"
SEAT = ("--robot.type=mart_seat", "--robot.arm=arm0", "--robot.name=learner")
HAND = ("--teleop.type=rehearsal_hand", "--teleop.z=0.5")


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A router and a room."""
    sim = ["sim", "--room", ROOM, "--seed", "1", "--control-hz", "20"]
    with (
        running_router() as endpoint,
        running_service(sim, endpoint, tmp_path_factory.mktemp("data"), kind="sim", id=ROOM),
    ):
        yield endpoint


@pytest.fixture
def client(endpoint: str) -> Iterator[RoomClient]:
    with RoomClient(endpoint, ROOM) as client:
        yield client


@pytest.fixture
def place(endpoint: str, tmp_path: Path) -> LeRobotPlace:
    return LeRobotPlace(tmp_path / "lerobot", endpoint)


class Turner(Operator):
    """Raises the tool of arm1 and closes its gripper."""

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        up_m = 0.02 if view.poses_tool_in_base["arm1"].position[2] < 0.4 else 0.0
        return {"arm1": view.step("arm1", (0, 0, up_m), gripper=1.0)}


@pytest.fixture
def driven(endpoint: str) -> Iterator[None]:
    """Somebody drives arm1."""
    stop = threading.Event()
    thread = threading.Thread(
        target=drive_seats, args=(Turner(), ROOM, ["arm1"]), kwargs={"router": endpoint, "stop": stop}
    )
    thread.start()
    yield
    stop.set()
    thread.join()


def test_a_seat_is_teleoperated(place: LeRobotPlace, client: RoomClient) -> None:
    done = place.run("lerobot-teleoperate", *SEAT, *HAND, "--fps=20", "--teleop_time_s=3")
    assert done.returncode == 0, done.stdout
    states = [state.arms[0] for state in client.states.all() if state.arms[0].source == OPERATOR_POLICY]
    assert states[-1].tool_in_base.z > states[0].tool_in_base.z + 0.05
    seated = client.statuses.wait_for(lambda status: status.seats[0].operator == OPERATOR_POLICY)
    assert seated.seats[0].name == "learner"
    client.statuses.wait_for(
        lambda status: status.seats[0].operator == OPERATOR_HOLD, since=len(client.statuses)
    )


def test_a_seat_is_recorded_with_a_picture_and_read_back(place: LeRobotPlace) -> None:
    folder = place.folder / "data_set"
    done = place.run(
        "lerobot-record",
        *SEAT,
        "--robot.viewpoints=[arm0]",
        "--robot.width=96",
        "--robot.height=64",
        *HAND,
        "--dataset.repo_id=mart/seat",
        f"--dataset.root={folder}",
        "--dataset.single_task=Lift the cube.",
        "--dataset.num_episodes=2",
        "--dataset.episode_time_s=2",
        "--dataset.reset_time_s=0",
        "--dataset.fps=20",
        "--dataset.push_to_hub=false",
        "--play_sounds=false",
    )
    assert done.returncode == 0, done.stdout
    read = place.run("python", Path(__file__).with_name("read_data_set.py"), folder)
    assert read.returncode == 0, read.stdout
    said = json.loads(read.stdout.splitlines()[-1])
    print(said)
    assert (said["episodes"], said["fps"], said["robot"]) == (2, 20, "mart_seat")
    assert said["frames"] >= 20
    assert said["names"][:3] == [f"arm0.tool_position_in_base.{axis}" for axis in range(3)]
    assert said["action"] == [0.0, 0.0, 0.5, 0.0, 0.0, 0.0, -1.0]
    assert said["heights_m"][1] > said["heights_m"][0]
    assert said["picture"] == [64, 96, 3]
    assert 0.05 < said["brightness"] < 0.95
    assert said["tasks"] == ["Lift the cube."]


@pytest.mark.usefixtures("driven")
def test_whoever_drives_an_arm_leads_a_robot_of_lerobots(place: LeRobotPlace, client: RoomClient) -> None:
    followed = place.folder / "followed.json"
    names = ",".join(f"joint{number}.pos" for number in range(1, 8))
    done = place.run(
        "lerobot-teleoperate",
        "--robot.type=rehearsal_arm",
        f"--robot.report={followed}",
        "--teleop.type=mart_arm",
        "--teleop.arm=arm1",
        f"--teleop.joints=[{names}]",
        "--fps=20",
        "--teleop_time_s=3",
    )
    assert done.returncode == 0, done.stdout
    at = json.loads(followed.read_text())
    seen = next(
        one.value for one in client.states.all()[-1].observations if one.name == "arm1/joint_positions"
    )
    assert [at[f"joint{number}.pos"] * 3.14159265 / 180.0 for number in range(1, 8)] == pytest.approx(
        list(seen), abs=0.02
    )
    assert at["gripper.pos"] < 50.0


@pytest.mark.usefixtures("driven")
@pytest.mark.parametrize(
    ("robot", "said"),
    [
        (("--robot.arm=arm1",), "Conflict"),
        (("--robot.arm=arm9",), "NotFound: There is no arm of room-1 'arm9'"),
        (("--robot.room=room-9",), "Unavailable: room-9 cannot be reached"),
        (("--robot.kind=script",), "it may be policy or human"),
        (("--robot.router=tcp/127.0.0.1:9",), "Unavailable"),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(place: LeRobotPlace, robot: tuple[str, ...], said: str) -> None:
    done = place.run("lerobot-teleoperate", "--robot.type=mart_seat", *robot, *HAND, "--teleop_time_s=1")
    assert done.returncode != 0
    assert said in done.stdout.splitlines()[-1], done.stdout
