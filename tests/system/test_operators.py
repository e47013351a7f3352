"""Programs of other people in a seat of a real room: a good one succeeds, a bad one is left, and the room goes on."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from mart.operators import Operator, OperatorKind, SeatView, ToolTarget, drive_seats
from mart.protocol.errors import Conflict, InvalidInput, NotFound, Unavailable
from mart.protocol.messages import OPERATOR_HOLD, OPERATOR_HUMAN, OPERATOR_SCRIPT
from tests.support.processes import environment_at, running_router, running_service
from tests.system.room_client import RoomClient

ROOM = "room-1"
EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A router, a room and its scripts."""
    data_dir = tmp_path_factory.mktemp("data")
    with (
        running_router() as endpoint,
        running_service(
            ["sim", "--room", ROOM, "--seed", "1", "--control-hz", "20"],
            endpoint,
            data_dir,
            kind="sim",
            id=ROOM,
        ),
        running_service(["experts"], endpoint, data_dir, kind="experts", id="experts"),
    ):
        yield endpoint


@pytest.fixture
def client(endpoint: str) -> Iterator[RoomClient]:
    with RoomClient(endpoint, ROOM) as client:
        yield client


class Failing(Operator):
    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        raise RuntimeError("the camera is gone")


class Rubbish(Operator):
    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        return {"arm1": "up"}  # type: ignore[dict-item]  # that is the point


class Hanging(Operator):
    def __init__(self) -> None:
        self.freed = threading.Event()

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        self.freed.wait()
        return {}


def goes_on(client: RoomClient) -> bool:
    """Whether the room ticks, with nobody at arm1 and a script at arm0."""
    client.assign("arm0", OPERATOR_SCRIPT)
    tick = client.states.wait_for(lambda _: True).tick
    client.states.wait_for(lambda state: state.tick > tick + 10)
    status = client.statuses.wait_for(lambda status: status.seats[1].operator == OPERATOR_HOLD)
    return all(seat.arm != "arm1" or not seat.holder_tag for seat in status.seats)


def test_the_example_succeeds_beside_a_script(endpoint: str) -> None:
    done = subprocess.run(
        [sys.executable, EXAMPLES / "06_operator_of_your_own.py", ROOM],
        env=environment_at(endpoint),
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "success" in done.stdout


def test_the_example_of_an_input_device_drives_as_a_person(endpoint: str, client: RoomClient) -> None:
    client.assign("arm0", OPERATOR_SCRIPT)
    with subprocess.Popen(
        [sys.executable, EXAMPLES / "07_input_device.py", "arm1"],
        env=environment_at(endpoint),
        stdin=subprocess.PIPE,
        text=True,
    ) as device:
        assert device.stdin is not None
        before = client.states.wait_for(lambda state: state.arms[1].source == OPERATOR_HUMAN).arms[1]
        device.stdin.write("rrrrr")
        device.stdin.flush()
        client.states.wait_for(
            lambda state: state.arms[1].tool_in_base.z > before.tool_in_base.z + 0.02, timeout_s=30.0
        )
        device.stdin.write("q")
        device.stdin.close()
        assert device.wait(30.0) == 0
    client.statuses.wait_for(lambda status: status.seats[1].operator == OPERATOR_HOLD)


def test_a_program_is_no_script(endpoint: str) -> None:
    with pytest.raises(InvalidInput):
        drive_seats(Failing(), ROOM, ["arm1"], kind=OperatorKind.SCRIPT, router=endpoint)


@pytest.mark.parametrize(
    ("operator", "error"), [(Failing(), InvalidInput), (Rubbish(), InvalidInput), (Hanging(), Unavailable)]
)
def test_a_bad_program_is_left_in_a_sentence_and_the_room_goes_on(
    endpoint: str, client: RoomClient, operator: Operator, error: type[Exception]
) -> None:
    with pytest.raises(error):
        drive_seats(operator, ROOM, ["arm1"], name="stranger", time_limit_s=0.5, router=endpoint)
    client.events.wait_for(
        lambda event: event.notice.level == "error" and event.notice.text.startswith("stranger left its seat")
    )
    assert goes_on(client)


def test_a_taken_seat_and_an_unknown_arm_are_refused(endpoint: str, client: RoomClient) -> None:
    client.claim("arm1", "ana")
    with pytest.raises(Conflict):
        drive_seats(Failing(), ROOM, ["arm1"], router=endpoint)
    with pytest.raises(NotFound):
        drive_seats(Failing(), ROOM, ["arm7"], router=endpoint)
    client.statuses.wait_for(lambda status: status.seats[1].operator == OPERATOR_HUMAN)
