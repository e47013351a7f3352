"""Episodes are judged by a replica whose processor lacks what the recording one had: none is called diverged."""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.episodes.mcap_entries import state_entries
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.messages import ArmState, Model, Numerics, State
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import Verdict
from mart.recorder.verify.replica import replica
from mart.recorder.verify.resimulation import verify
from mart.rollouts.client import RolloutClient
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.steady_libm import TUNABLES
from tests.support.processes import running_router, running_service

TASK = "two_arm_multi_cube_lifting"
TICKS = 60
FULL, OTHER = "full", "other"
_WITHOUT = {TUNABLES: "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX,-FMA4"}
_OLD = Path(__file__).parents[1] / "fixtures" / "episodes_0_1_0" / "episodes.tar.xz"


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A router with two replicas: of this processor, and of one without FMA and AVX2."""
    data = tmp_path_factory.mktemp("data")
    own = {TUNABLES: ""}
    with (
        running_router() as endpoint,
        running_service(["replica", "--name", FULL], endpoint, data, "replica", FULL, environment=own),
        running_service(["replica", "--name", OTHER], endpoint, data, "replica", OTHER, environment=_WITHOUT),
    ):
        yield endpoint


def judged(endpoint: str, name: str, path: Path) -> VerificationRecord:
    with ZenohBus.connect(endpoint) as bus:
        file = EpisodeFile.open(path)
        return verify(file, file.room, replica(bus, name))


def some_actions() -> NDArray[np.float64]:
    """Reach down and close, so that there are contacts."""
    actions = np.random.default_rng(4).uniform(-1, 1, (TICKS, 2, 7))
    actions[:, :, 2] = -0.8
    return actions


def write(path: Path, model: Model, numerics: Numerics, states: list[bytes]) -> Path:
    """The states of an episode and the actions that led to each, as the recorder writes them."""
    file = EpisodeWriter(path)
    room = RoomRecord(room="room-1", task=TASK, control_hz=20.0, model_sha256=model.sha256)
    file.describe(room.with_numerics(numerics))
    file.attach_model(model, 0)
    for tick, integration_state in enumerate(states):
        action = some_actions()[max(tick - 1, 0)]
        arms = [ArmState(arm=f"arm{i}", action=row) for i, row in enumerate(action.tolist())]
        state = State(tick=tick, integration_state=integration_state, arms=arms)
        for entry in state_entries(state, codec.encode(state), 0, TASK)[:1]:
            file.add(entry)
    file.finish()
    file.move_to(path)
    return path


def recorded_by_a_service(endpoint: str, path: Path) -> Path:
    with ZenohBus.connect(endpoint) as bus, RolloutClient(bus, [FULL]) as client:
        stood = [client.reset(TASK, [7], integration_states=True)]
        stood += [client.step(action[None]) for action in some_actions()]
        model = client.model(TASK)
    states = [one.integration_states[0].tobytes() for one in stood if one.integration_states is not None]
    return write(path, model, model.numerics, states)


def test_what_a_service_recorded_is_verified_by_both(endpoint: str, tmp_path: Path) -> None:
    path = recorded_by_a_service(endpoint, tmp_path / "service.mcap")
    for name in (FULL, OTHER):
        said = judged(endpoint, name, path)
        assert said.verdict is Verdict.VERIFIED, said.detail
        assert said.numeric_fingerprint == EpisodeFile.open(path).room.numeric_fingerprint


def test_what_0_1_0_recorded_is_verified_on_its_processor_and_diverges_on_none(
    endpoint: str, tmp_path: Path
) -> None:
    with tarfile.open(_OLD) as archive:
        archive.extractall(tmp_path, filter="data")
    for path in sorted(tmp_path.rglob("*.mcap")):
        said = judged(endpoint, FULL, path)
        assert (said.verdict, said.within_tolerance) == (Verdict.VERIFIED, None), said.detail
        said = judged(endpoint, OTHER, path)
        assert said.verdict is not Verdict.DIVERGED, said.detail
        if said.verdict is Verdict.UNVERIFIED:
            assert "before fingerprints" in said.detail
            assert (said.within_tolerance, said.pending) == (True, False)


_PROGRAM = """
import sys
import numpy as np
from mart.sim.world import World
from mart.sim.world.model_message import model_message
world = World.build(sys.argv[1])
world.reset(7)
states = [world.integration_state()]
for action in np.load("actions.npy"):
    world.step(action)
    states.append(world.integration_state())
np.save("states.npy", np.array([np.frombuffer(state) for state in states]))
open("model", "wb").write(model_message(world).SerializeToString())
"""


def recorded_by_a_program(path: Path) -> Path:
    """It computes as its processor does it best, which services do not."""
    np.save(path.parent / "actions.npy", some_actions())
    subprocess.run(
        [sys.executable, "-c", _PROGRAM, TASK], cwd=path.parent, env={**os.environ, TUNABLES: ""}, check=True
    )
    model = codec.decode(Model, (path.parent / "model").read_bytes())
    states = [state.tobytes() for state in np.load(path.parent / "states.npy")]
    return write(path, model, model.numerics, states)


def test_what_a_program_of_somebody_recorded_is_verified_on_its_processor_and_diverges_on_none(
    endpoint: str, tmp_path: Path
) -> None:
    path = recorded_by_a_program(tmp_path / "mine.mcap")
    said = judged(endpoint, FULL, path)
    assert said.verdict is Verdict.VERIFIED, said.detail
    said = judged(endpoint, OTHER, path)
    if said.verdict is not Verdict.VERIFIED:  # this processor has FMA
        assert said.verdict is Verdict.UNVERIFIED
        assert said.detail.startswith("Other processor")
        assert said.first_different_tick is not None
        assert (said.within_tolerance, said.pending) == (True, False)
