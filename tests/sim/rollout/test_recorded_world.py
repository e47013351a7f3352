"""Recordings of somebody's own task are stepped again from what they carry; its files need not be there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import RolloutRequest
from mart.protocol.state_digest import state_digest
from mart.protocol.tasks import get_task, recorded_task
from mart.sim.rollout.compiled_worlds import CompiledWorlds
from mart.sim.rollout.resimulation import Resimulator
from mart.sim.world import World
from mart.sim.world.model_message import model_message
from tests.support.drawer_demonstration import TASK_FILE, demonstrate


@pytest.fixture(scope="module")
def recording() -> tuple[RolloutRequest.Resimulate, list[bytes]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MART_TASKS_DIR", str(TASK_FILE.parent))
        world = World.build("two_arm_drawer")
    actions, states = [], []
    for action in demonstrate(world, 1):
        actions.append(action)
        states.append(world.integration_state())
    model = model_message(world)
    return RolloutRequest.Resimulate(
        model_sha256=model.sha256,
        task=model.task,
        control_hz=model.control_hz,
        arms=2,
        first_state=states[99],
        actions=np.array(actions[100:]).tobytes(),
        task_file=model.task_file,
        mjb=model.mjb,
    ), [state_digest(state) for state in states[100:]]


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MART_TASKS_DIR", str(tmp_path))


def test_it_follows_bit_for_bit(recording: tuple[RolloutRequest.Resimulate, list[bytes]]) -> None:
    request, digests = recording
    with pytest.raises(NotFound):
        get_task(request.task)
    reply = Resimulator(CompiledWorlds()).resimulate(request)
    assert reply.state_digests == b"".join(digests)
    assert recorded_task(request.task, request.task_file, ("ur5e", "panda")).arm_kinds == ("ur5e", "panda")


def test_what_does_not_hold_together_is_refused(
    recording: tuple[RolloutRequest.Resimulate, list[bytes]],
) -> None:
    def changed(**fields: object) -> RolloutRequest.Resimulate:
        request = RolloutRequest.Resimulate()
        request.CopyFrom(recording[0])
        for name, value in fields.items():
            setattr(request, name, value)
        return request

    resimulator = Resimulator(CompiledWorlds())
    with pytest.raises(Corrupt):
        resimulator.resimulate(changed(mjb=b"something else"))
    with pytest.raises(InvalidInput, match="not TOML"):
        resimulator.resimulate(changed(task_file=b"title = "))
    other = recording[0].task_file.replace(b'"handle"', b'"handles"')
    with pytest.raises(InvalidInput, match="handles"):
        resimulator.resimulate(changed(task_file=other))
