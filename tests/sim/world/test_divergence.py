"""Worlds that truly leave their bounds: told, kept, and led there again from the file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mart.protocol import clock
from mart.protocol.errors import Corrupt
from mart.sim.world import Diverged, World, WorldBatch, divergence
from mart.sim.world.divergence import DivergenceArchive

TASK = "two_arm_multi_cube_lifting"
ACTIONS = np.random.default_rng(2).uniform(-1, 1, (9, 3, 2, 7))


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def archive(folder: Path) -> DivergenceArchive:
    return DivergenceArchive(folder, "room-1", clock.wall_ns)


def break_down(world: World) -> Diverged:
    """After eight good steps its velocities become absurd."""
    world.reset(1)
    for actions in ACTIONS[:8, 0]:
        world.step(actions)
    world.data.qvel[:] = 1e9
    with pytest.raises(Diverged, match=r"after 0\.400 s") as caught:
        world.step(ACTIONS[8, 0])
    return caught.value


def test_the_file_leads_a_world_there_again(world: World, tmp_path: Path) -> None:
    diverged = break_down(world)
    said = archive(tmp_path / "diverged").keep(diverged)
    (path,) = (tmp_path / "diverged").iterdir()
    assert str(path) in said
    assert path.name.endswith(f"-room-1-{TASK}.npz")
    last = divergence.load(path)
    assert (last.task, last.control_hz, last.model_sha256) == (TASK, 20.0, world.model_sha256)
    assert last.actions.tolist() == ACTIONS[4:9, 0].tolist()
    again = World.build(last.task, last.control_hz, arms=last.actions.shape[1])
    again.set_integration_state(last.states[0].tobytes())
    for actions, state in zip(last.actions[:3], last.states[1:4], strict=True):
        again.step(actions)
        assert [again.data.time, *again.data.qpos, *again.data.qvel] == state[
            : 1 + again.model.nq + again.model.nv
        ].tolist()
    again.set_integration_state(last.states[-1].tobytes())
    with pytest.raises(Diverged):
        again.step(last.actions[-1])


def test_in_a_batch_one_fails_and_the_others_go_on(world: World) -> None:
    errors: list[Diverged] = []

    def explain(error: Diverged) -> str:
        errors.append(error)
        return "It broke."

    seeds, everyone = (1, 2, 3), np.ones(3, bool)
    batch, unharmed = WorldBatch(world, 3, threads=2, explain=explain), WorldBatch(world, 3, threads=2)
    for worlds in (batch, unharmed):
        worlds.reset(seeds)
        for actions in ACTIONS[:6]:
            worlds.step(actions, everyone)
    batch._batch.qvel[1] = 1e9
    broken = batch.integration_states()[1]
    for actions in ACTIONS[6:]:
        batch.step(actions, everyone)
        unharmed.step(actions, everyone)
        standing = batch.standing()
        assert standing.reasons == ("", "It broke.", "")
        assert standing.failed.tolist() == [False, True, False]
        for name, seen in standing.observations.items():
            assert np.isfinite(seen).all(), name
    assert batch.integration_states()[1].tobytes() == broken.tobytes()
    for number in (0, 2):
        assert batch.integration_states()[number].tobytes() == unharmed.integration_states()[number].tobytes()
    (error,) = errors
    assert error.last.actions.tolist() == ACTIONS[2:7, 1].tolist()
    world.set_integration_state(error.last.states[-1].tobytes())
    with pytest.raises(Diverged):
        world.step(error.last.actions[-1])
    batch.reset(seeds)
    assert not batch.standing().failed.any()


def test_infinite_velocities_at_the_very_end_of_a_step_are_noticed_in_that_step(world: World) -> None:
    world.reset(1)
    world.substeps, usual = 1, world.substeps
    try:
        world.data.qacc_warmstart[:] = 0.0
        world.data.qfrc_applied[:] = 1e13
        with pytest.raises(Diverged):
            world.step(ACTIONS[0, 0])
    finally:
        world.substeps = usual
        world.data.qfrc_applied[:] = 0.0


def test_only_so_many_files_are_kept(world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(divergence, "MOST_FILES", 3)
    diverged, keep = break_down(world), archive(tmp_path).keep
    said = [keep(diverged) for _ in range(5)]
    assert {str(path) for path in tmp_path.iterdir()} == {
        text.partition(" are in ")[2].removesuffix(".") for text in said[2:]
    }


def test_a_folder_that_cannot_be_written_is_told(world: World, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert "could not be kept" in archive(tmp_path / "file").keep(break_down(world))


@pytest.mark.parametrize("content", [b"", b"PK no zip", b"\x93NUMPY"])
def test_another_file_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.npz"
    path.write_bytes(content)
    with pytest.raises(Corrupt):
        divergence.load(path)
