"""LeRobot's own loader, tools and training on an export of ours with pictures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mart.recorder.export_cli import export
from mart.sim.world import World
from tests.lerobot.environment import LeRobotPlace
from tests.recorder.export.test_pictures import drawn
from tests.trainer import recorded

_TICKS = 24
_SCRIPT = Path(__file__).with_name("read_export.py")
_MEAN_ERROR = 6.0  # of 255: 96 px are small, and H.264 halves colours' resolution
_TRAINING = (
    "--dataset.repo_id=mart/export",
    "--policy.device=cpu",
    "--policy.push_to_hub=false",
    "--policy.pretrained_backbone_weights=null",
    '--policy.normalization_mapping={"VISUAL":"MEAN_STD","STATE":"MEAN_STD","ENV":"MEAN_STD","ACTION":"MEAN_STD"}',
    "--steps=2",
    "--batch_size=2",
    "--num_workers=0",
    "--log_freq=1",
    "--save_freq=2",
    "--job_name=tiny",
)
_POLICIES = {
    "act": (
        "--policy.chunk_size=10",
        "--policy.n_action_steps=10",
        "--policy.dim_model=64",
        "--policy.n_heads=4",
        "--policy.dim_feedforward=128",
        "--policy.n_encoder_layers=1",
        "--policy.latent_dim=8",
        "--policy.n_vae_encoder_layers=1",
    ),
    "diffusion": (
        "--policy.n_obs_steps=2",
        "--policy.horizon=8",
        "--policy.n_action_steps=4",
        "--policy.down_dims=[32,64]",
        "--policy.diffusion_step_embed_dim=32",
        "--policy.spatial_softmax_num_keypoints=8",
        "--policy.crop_shape=[84,84]",
        "--policy.num_train_timesteps=20",
        "--policy.num_inference_steps=5",
    ),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes, and two exports of them: `two` and `one`."""
    root, world = tmp_path_factory.mktemp("exports"), World.build(recorded.TASK)
    for seed in (1, 2, 3):
        states = recorded.perform(world, seed, number=seed, most_ticks=_TICKS)
        recorded.write(root / ("one-of" if seed == 3 else "two-of"), world, states, with_model=True)
    for name in ("one", "two"):
        command = [str(root / f"{name}-of"), "--format", "lerobot", "--out", str(root / name), "--jobs", "1"]
        export.main([*command, "--camera", "arm0:96x96", "--camera", "front:96x96"], standalone_mode=False)
    return root


def test_it_is_loaded_deleted_from_split_and_merged(folder: Path, tmp_path: Path) -> None:
    done = LeRobotPlace(tmp_path / "lerobot").run("python", _SCRIPT, folder / "two", folder / "one", tmp_path)
    assert done.returncode == 0, done.stdout
    said = json.loads(done.stdout.splitlines()[-1])
    assert (said["frames"], said["episodes"], said["shape"]) == (2 * _TICKS, 2, [3, 96, 96])
    sources = sorted((folder / "two-of").rglob("*.mcap"))
    wanted = np.concatenate([drawn(path, "arm0", 96, 96)[:-1] for path in sources]).astype(np.float64)
    seen = 255.0 * np.load(tmp_path / "pictures.npy").transpose(0, 2, 3, 1)
    error = np.abs(seen - wanted).mean(axis=(1, 2, 3))
    print(f"mean error of a picture: {error.mean():.2f} of 255, {error.max():.2f} at most")
    assert error.max() < _MEAN_ERROR
    means = [wanted[:_TICKS].mean((0, 1, 2)) / 255.0, wanted[_TICKS:].mean((0, 1, 2)) / 255.0]
    for name, mean in (("data", sum(means) / 2), ("left", means[1]), ("second", means[1])):
        np.testing.assert_allclose(np.ravel(said[name]["picture"]), mean, atol=1e-6)
        assert max(said[name]["action"]) > 0.0
    assert [said[name]["episodes"] for name in ("left", "second", "merged")] == [1, 1, 3]


@pytest.mark.parametrize("policy", _POLICIES)
def test_a_tiny_policy_trains_on_it(folder: Path, tmp_path: Path, policy: str) -> None:
    chosen = (f"--policy.type={policy}", *_POLICIES[policy], f"--dataset.root={folder / 'two'}")
    done = LeRobotPlace(tmp_path / "lerobot").run(
        "lerobot-train", *_TRAINING, *chosen, f"--output_dir={tmp_path / 'trained'}"
    )
    assert done.returncode == 0, done.stdout
    assert (tmp_path / "trained/checkpoints/000002/pretrained_model/model.safetensors").is_file()


def test_lerobot_doctor_finds_nothing_broken(folder: Path, tmp_path: Path) -> None:
    done = LeRobotPlace(tmp_path / "lerobot").run(
        "lerobot-doctor", "check", folder / "two", "--fail-on", "fail"
    )
    assert done.returncode == 0, done.stdout
    for part in (
        "Metadata & Format Compliance",
        "Temporal Consistency",
        "Video Integrity",
        "Feature Consistency",
    ):
        assert f"[PASS] {part}" in done.stdout, done.stdout
