"""Episodes with a real arm go the whole way: recorded, exported, learned from, sent to the arm; a policy seated."""

from __future__ import annotations

import contextlib
import json
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from mart.episodes.reader import EpisodeFile
from mart.protocol import clock
from mart.protocol.messages import (
    OPERATOR_POLICY,
    OUTCOME_SUCCESS,
    EpisodeRequest,
    SeatRequest,
)
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import Verdict
from mart.runtime.cli import cli
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.support.processes import Running, running_router, running_service, started
from tests.system.real_arms import Hardware, Person, Swinger, until
from tests.system.room_client import RoomClient

ROOM, TASK = "room-1", "two_arm_multi_cube_lifting"
REAL = "arm0"
RECORDED_TICKS = 40
_HOLDER = f"holder-of-{REAL}"
_TRIES = 6  # on a machine that does other things, too


class Lab:
    """A room with one real and one simulated arm, its recorder, and a person who swings the real one."""

    def __init__(self, endpoint: str, data_dir: Path, hardware: Hardware, client: RoomClient) -> None:
        self.endpoint, self.data_dir, self.hardware, self.client = endpoint, data_dir, hardware, client

    def go_on(self) -> None:
        """A person lets the stop go, as soon as the driver is ready."""

        def goes_on() -> bool:
            self.client.episode(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva")))
            return not self.client.statuses.wait_next().HasField("stop")

        until(goes_on, lambda: "The room does not go on.", timeout_s=60.0)

    def record(self) -> Path:
        """The person swings the real arm, and says that it went well; the simulated one holds."""
        person = Person(self.client, REAL, get_task(TASK), Swinger())
        try:
            ready = EpisodeRequest.Ready(arm=REAL, holder_id=_HOLDER, ready=True)
            assert not self.client.episode(EpisodeRequest(ready=ready)).error.code
            until(self._records, lambda: "No episode begins.", timeout_s=60.0)
            self._swing(person)
            finish = EpisodeRequest.Finish(holder_id=_HOLDER, outcome=OUTCOME_SUCCESS)
            before = len(self.client.events)
            assert not self.client.episode(EpisodeRequest(finish=finish)).error.code
            saved = self.client.events.wait_for(lambda event: event.HasField("episode_saved"), 60.0, before)
        finally:
            person.close()
            self.client.seat(SeatRequest(release=SeatRequest.Release(arm=REAL, holder_id=_HOLDER)))
        return self.data_dir / saved.episode_saved.path

    def _records(self) -> bool:
        self.go_on()  # whatever stops the room meanwhile
        return self.client.states.wait_next().episode > 0

    def _swing(self, person: Person) -> None:
        """Until it has swung for a while, whatever stops the room meanwhile."""
        ticks = 0
        while ticks < RECORDED_TICKS:
            if self.client.statuses.wait_next().HasField("stop"):
                self.go_on()
            if not person.engaged or not self.hardware.moved_rad(clock.monotonic_s() - 0.2) > 0.005:
                person.release()
                clock.sleep_s(0.25)
                person.press()
            before = len(self.client.states)
            clock.sleep_s(0.5)
            ticks += len(self.client.states) - before

    @contextlib.contextmanager
    def replaying(self, path: Path) -> Iterator[Running]:
        """The recorded way is sent to the real arm, at half its speed."""
        self.go_on()
        command = ["episodes", "replay", str(path), "--to-drivers", "--yes", "--speed", "0.5", "--json"]
        with started(command, self.endpoint, self.data_dir) as running:
            yield running

    def swings(self) -> bool:
        return self.hardware.moved_rad(clock.monotonic_s() - 0.2) > 0.02


def ended(running: Running) -> dict[str, Any]:
    """How a replay ended: what it printed, or the sentence with which it was refused."""
    code = running.process.wait(90.0)
    last = running.log().splitlines()[-1]
    said: dict[str, Any] = json.loads(last) if last.startswith("{") else {"why_ended": last}
    return said | {"code": code}


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    data_dir = tmp_path_factory.mktemp("real-episodes")
    hardware = Hardware(seed=3)
    sim = ["sim", "--room", ROOM, "--task", TASK, "--seed", "1", "--control-hz", "20", "--driver", REAL]
    with contextlib.ExitStack() as opened:
        opened.callback(hardware.close)
        endpoint = opened.enter_context(running_router())
        hardware.await_port()
        driver = ["driver", "--room", ROOM, "--arm", REAL, "--driver", "mart.driver.simulated:SimulatedArm"]
        driver += ["--option", f"address=127.0.0.1:{hardware.port}"]
        driver += ["--tool-speed-m-s", "0.5", "--joint-speed-rad-s", "2"]
        opened.enter_context(started(driver, endpoint, data_dir))
        recorder = ["recorder", "--name", "recorder-1"]
        opened.enter_context(running_service(recorder, endpoint, data_dir, kind="recorder", id="recorder-1"))
        opened.enter_context(running_service(sim, endpoint, data_dir, kind="sim", id=ROOM))
        client = opened.enter_context(RoomClient(endpoint, ROOM))
        lab = Lab(endpoint, data_dir, hardware, client)
        lab.go_on()
        yield lab


@pytest.fixture(scope="module")
def path(lab: Lab) -> Path:
    return lab.record()


def test_it_is_told_to_be_real_and_exports(lab: Lab, path: Path) -> None:
    file = EpisodeFile.open(path)
    assert (file.verification.verdict, file.episode.measured_arms) == (Verdict.REAL, (REAL,))
    assert file.verification.detail == f"Not re-simulated: real. Measured: {REAL}."
    out = lab.data_dir / "exported.hdf5"
    done = CliRunner().invoke(
        cli, ["episodes", "export", str(path), "--format", "robomimic", "--out", str(out), "--json"]
    )
    assert json.loads(done.stdout)["episodes"] == 1


def test_the_arm_goes_the_recorded_way_again(lab: Lab, path: Path) -> None:
    recorded_s = EpisodeFile.open(path).arrays().sim_time_s
    told: list[dict[str, Any]] = []
    begun_s = clock.monotonic_s()
    while not told or (told[-1]["code"] != 0 and len(told) < _TRIES):
        with lab.replaying(path) as running:
            told.append(ended(running))
    assert (told[-1]["code"], told[-1]["why_ended"]) == (0, ""), told
    assert told[-1]["arms"] == [REAL]
    # The way to the beginning is reckoned anew once the seat is taken: until then an arm sags by a hair.
    assert told[-1]["led_s"] == pytest.approx(told[-1]["of_s"], abs=0.1)
    assert told[-1]["of_s"] >= 2.0 * (recorded_s[-1] - recorded_s[0]) - 0.01
    rows = lab.hardware.history(begun_s)
    assert rows[:, 1].max() - rows[:, 1].min() > 0.1  # it swung about its base


def test_ctrl_c_ends_a_replay_and_the_arm_stands(lab: Lab, path: Path) -> None:
    told: list[dict[str, Any]] = []
    while not told or (told[-1]["why_ended"] != "It was asked to end." and len(told) < _TRIES):
        with lab.replaying(path) as running:
            until(lambda process=running.process: process.poll() is not None or lab.swings(), running.log)  # type: ignore[misc]
            running.process.send_signal(signal.SIGINT)
            told.append(ended(running))
    assert (told[-1]["code"], told[-1]["why_ended"]) == (1, "It was asked to end."), told
    clock.sleep_s(1.0)
    assert lab.hardware.moved_rad(clock.monotonic_s() - 0.5) < 0.002


def test_a_policy_learns_from_it_and_takes_the_real_arm_s_seat(lab: Lab, path: Path) -> None:
    request = TrainingSpec(
        model="d-BC", data=(path.parent,), preset="debug", changes={"updates": 3, "checkpoints": 1}
    )
    run_path = lab.data_dir / "run"
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv("MART_DATA_DIR", str(lab.data_dir))
        train(request, run_path, threading.Event(), lambda _: None)
    run = RunDirectory(run_path)
    checkpoint = run.checkpoint(run.checkpointed()[-1], 0)
    command = ["operate", "--checkpoint", str(checkpoint), "--room", ROOM, "--arm", REAL]
    with started(command, lab.endpoint, lab.data_dir) as running:

        def drives() -> bool:
            lab.go_on()
            assert running.process.poll() is None, running.log()
            arm = lab.client.states.wait_next().arms[0]
            return arm.measured and arm.fresh and arm.source == OPERATOR_POLICY

        until(drives, running.log, timeout_s=60.0)
