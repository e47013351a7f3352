"""A robot of LeRobot's own kind lifts a cube in a room of ours: `mart driver` runs where LeRobot is installed."""

from __future__ import annotations

import contextlib
import importlib.util
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from mart.operators import drive_seats
from mart.protocol.messages import EpisodeRequest
from mart.protocol.vocabulary import EpisodeOutcome
from tests.contract.repository import ROOT
from tests.lerobot.environment import LeRobotPlace
from tests.support.processes import running_router, running_service
from tests.system.room_client import RoomClient

ROOM = "room-1"
JOINTS = ",".join(f"joint{number}.pos" for number in range(1, 8))


@contextlib.contextmanager
def led_by_lerobot(folder: Path, endpoint: str, hangs: Path) -> Iterator[RoomClient]:
    """Let a robot of LeRobot's be arm0 of the room, and the room go on."""
    options = [
        "type=rehearsal_arm",
        "kind=panda",
        f"joints={JOINTS}",
        "gripper=gripper.pos",
        f"hang_file={hangs}",
    ]
    command = ["mart", "driver", "--room", ROOM, "--arm", "arm0"]
    command += ["--driver", "mart.driver.lerobot_arm:LeRobotArm"]
    command += [word for option in options for word in ("--option", option)]
    with (
        RoomClient(endpoint, ROOM) as client,
        LeRobotPlace(folder, endpoint).started(command) as log,
    ):
        ready = client.statuses.wait_for(
            lambda status: bool(status.driven_arms[0].driver) and not status.driven_arms[0].fault,
            timeout_s=120.0,
        )
        assert ready.driven_arms[0].driver == "LeRobotArm", log.read_text()
        client.episode(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Ana")))
        yield client


def test_it_lifts_a_cube_beside_a_simulated_arm_and_stops_the_room_where_it_hangs(tmp_path: Path) -> None:
    hangs = tmp_path / "hangs"
    sim = ["sim", "--room", ROOM, "--seed", "1", "--control-hz", "20", "--driver", "arm0"]
    data_dir = tmp_path / "data"
    with (
        running_router() as endpoint,
        running_service(sim, endpoint, data_dir, kind="sim", id=ROOM),
        running_service(["experts"], endpoint, data_dir, kind="experts", id="experts"),
        led_by_lerobot(tmp_path / "lerobot", endpoint, hangs) as client,
    ):
        (outcome,) = drive_seats(
            _example().CubeLifter(),
            ROOM,
            ["arm0"],
            name="cube lifter",
            control_hz=20.0,
            episodes=1,
            fill_with_scripts=True,
            router=endpoint,
        )
        assert outcome is EpisodeOutcome.SUCCESS
        assert client.states.all()[-1].arms[0].measured
        hangs.touch()
        stopped = client.statuses.wait_for(lambda status: status.HasField("stop"), since=len(client.statuses))
        assert "get_observation" in stopped.stop.fault
        assert "rehearsal_arm" in stopped.stop.fault


def _example() -> ModuleType:
    path = ROOT / "examples" / "06_operator_of_your_own.py"
    spec = importlib.util.spec_from_file_location("operator_of_your_own", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
