"""Pictures in exports: drawn from the very state before each action, or captured by then, and in step with the rows."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import av
import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray

from mart.episodes.reader import open_episode
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task
from mart.recorder.export_cli import export
from mart.render import Renderer, load_model
from mart.sim.world import World
from tests.recorder.catalogue.test_pictures import pictures
from tests.trainer import recorded

TASK = get_task(recorded.TASK)
TICKS = 12
CAMERAS = ("--camera", "arm0:48x32", "--camera", "front:32x32")


def write(episodes: Path, out: Path, file_format: str, *arguments: str) -> None:
    command = [str(episodes), "--format", file_format, "--out", str(out), "--jobs", "1", *arguments]
    export.main(command, standalone_mode=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes of the simulation, and one of the same that a camera named table watched."""
    root, world = tmp_path_factory.mktemp("episodes"), World.build(recorded.TASK)
    both = [recorded.perform(world, seed, number=seed, most_ticks=TICKS) for seed in (1, 2)]
    for states in both:
        recorded.write(root / "drawn", world, states, with_model=True)
    begin_ns = both[1][0].stamps.sent_ns
    captured = [
        (begin_ns + number * 30_000_000 + 10_000_000, frame.data)
        for number, frame in enumerate(pictures(640, 496))
    ]
    recorded.write(root / "captured", world, both[1], with_model=True, captured={"table": captured})
    return root


@pytest.fixture(scope="module")
def lerobot(folder: Path) -> Path:
    write(folder / "drawn", folder / "lifting", "lerobot", *CAMERAS)
    return folder / "lifting"


def played(path: Path) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    with av.open(str(path)) as video:
        for frame in video.decode(video=0):
            assert frame.time is not None
            yield frame.time, frame.to_ndarray(format="rgb24").astype(np.uint8)


def drawn(path: Path, viewpoint: str, width_px: int, height_px: int) -> list[NDArray[np.uint8]]:
    file = open_episode(path)
    room = file.room
    model = load_model(
        file.model(), sha256=room.model_sha256 or "", mujoco_version=str(room.mujoco_version), source="it"
    )
    with closing(Renderer(model, viewpoint, width_px, height_px)) as renderer:
        return [renderer.draw(state.integration_state) for state in file.states()]


def test_a_video_shows_what_was_seen_before_each_action_at_its_time(folder: Path, lerobot: Path) -> None:
    rows = pq.read_table(lerobot / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    sources = sorted((folder / "drawn").rglob("*.mcap"))
    for key, size in (("arm0", (48, 32)), ("front", (32, 32))):
        feature = f"observation.images.{key}"
        for number, (row, source) in enumerate(zip(rows, sources, strict=True)):
            where = row[f"videos/{feature}/chunk_index"], row[f"videos/{feature}/file_index"]
            assert where == (0, number)
            found = [*played(lerobot / f"videos/{feature}/chunk-000/file-{number:03d}.mp4")]
            wanted = drawn(source, key, *size)[:-1]
            assert [at_s for at_s, _ in found] == pytest.approx(
                [k / 20.0 for k in range(row["length"])], abs=1e-6
            )
            assert row[f"videos/{feature}/from_timestamp"] == 0.0
            assert row[f"videos/{feature}/to_timestamp"] == pytest.approx(row["length"] / 20.0)
            seen = np.array([picture for _, picture in found], np.float64)
            assert np.abs(seen - np.array(wanted)).mean() < 6.0


def test_colours_are_counted_from_the_drawn_pictures(folder: Path, lerobot: Path) -> None:
    info = json.loads((lerobot / "meta/info.json").read_text())
    stats = json.loads((lerobot / "meta/stats.json").read_text())["observation.images.front"]
    assert info["video_path"] == "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
    assert info["features"]["observation.images.front"]["shape"] == [32, 32, 3]
    assert info["features"]["observation.images.front"]["names"] == ["height", "width", "channels"]
    every = [
        picture
        for path in sorted((folder / "drawn").rglob("*.mcap"))
        for picture in drawn(path, "front", 32, 32)[:-1]
    ]
    pixels = np.array(every, np.float64).reshape(-1, 3) / 255.0
    assert stats["count"] == [len(every)]
    for name, wanted in (("mean", pixels.mean(0)), ("std", pixels.std(0)), ("min", pixels.min(0))):
        np.testing.assert_allclose(np.array(stats[name]), wanted.reshape(3, 1, 1), atol=1e-12)
    np.testing.assert_allclose(np.array(stats["q50"]).ravel(), np.quantile(pixels, 0.5, axis=0), atol=1 / 255)


def test_robomimic_has_pictures_before_and_after_and_what_was_asked_besides(folder: Path) -> None:
    out = folder / "lifting.hdf5"
    write(folder / "drawn", out, "robomimic", "--camera", "arm0:48x32", "--depth", "--segmentation")
    source = min((folder / "drawn").rglob("*.mcap"))
    wanted = np.array(drawn(source, "arm0", 48, 32))
    with h5py.File(out) as file:
        demo = file["data/demo_0"]
        np.testing.assert_array_equal(demo["obs/arm0_image"][:], wanted[:-1])
        np.testing.assert_array_equal(demo["next_obs/arm0_image"][:], wanted[1:])
        assert demo["obs/arm0_image"].chunks == (1, 32, 48, 3)
        depth_m, bodies = demo["obs/arm0_depth"], demo["obs/arm0_segmentation"]
        assert (depth_m.dtype, depth_m.shape) == (np.float32, (TICKS, 32, 48, 1))
        assert (bodies.dtype, bodies.shape) == (np.int32, (TICKS, 32, 48, 1))
        names = json.loads(demo.attrs["bodies"])
        assert {names[str(number)] for number in np.unique(bodies[:]) if number >= 0} >= {
            "world",
            "arm0/hand",
        }
        arguments = json.loads(file["data"].attrs["env_args"])["env_kwargs"]
        assert (arguments["camera_names"], arguments["camera_heights"]) == (["arm0"], [32])
    assert "drawn anew" in (folder / "lifting.md").read_text()


def test_captured_pictures_are_the_newest_at_each_tick(folder: Path) -> None:
    """Picture n, of grey 4 n, was captured at 30 n + 10 ms, and tick t came at 50 t ms."""
    out = folder / "captured.hdf5"
    write(folder / "captured", out, "robomimic", "--camera", "table:32x24")
    with h5py.File(out) as file:
        grey = file["data/demo_0/obs/table_image"][:].astype(float).mean(axis=(1, 2, 3)) / 4.0
    newest = [max(0, (50 * tick - 10) // 30) for tick in range(TICKS)]
    np.testing.assert_allclose(grey, newest, atol=0.5)
    assert "captured by a real camera" in (folder / "captured.md").read_text()


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (("--camera", "elbow:32x32"), NotFound),
        (("--camera", "arm0"), InvalidInput),
        (("--camera", "arm0:33x32"), InvalidInput),
        (("--camera", "arm0:9000x32"), InvalidInput),
        (("--camera", "arm0:32x32", "--camera", "arm0:48x48"), InvalidInput),
        (("--camera", "arm0:32x32", "--control-hz", "12.5"), InvalidInput),
        (("--camera", "arm0:32x32", "--depth"), InvalidInput),
    ],
)
def test_what_cannot_be_had_is_refused_and_leaves_nothing(
    folder: Path, tmp_path: Path, arguments: tuple[str, ...], error: type[Exception]
) -> None:
    with pytest.raises(error):
        write(folder / "drawn", tmp_path / "lifting", "lerobot", *arguments)
    assert not [*tmp_path.iterdir()]


def test_a_camera_that_is_real_in_some_episodes_alone_is_refused(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="1 of 3"):
        write(folder, tmp_path / "lifting", "lerobot", "--camera", "table:32x32")


@pytest.mark.parametrize("arguments", [(), ("--with-names",)])
def test_people_are_named_only_where_it_is_asked_for(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    world = World.build(recorded.TASK)
    states = recorded.perform(world, 1, most_ticks=TICKS)
    recorded.write(tmp_path / "episodes", world, states, name="Ana Example")
    for file_format, out, card in (
        ("robomimic", "lifting.hdf5", "lifting.md"),
        ("lerobot", "lifting", "lifting/README.md"),
    ):
        write(tmp_path / "episodes", tmp_path / out, file_format, *arguments)
        assert ("Ana Example" in (tmp_path / card).read_text()) == bool(arguments)
        written = tmp_path / out
        files = [written] if written.is_file() else [one for one in written.rglob("*") if one.is_file()]
        assert any(b"Ana Example" in one.read_bytes() for one in files) == bool(arguments)
    with h5py.File(tmp_path / "lifting.hdf5") as file:
        assert ("Ana Example" in file["data/demo_0"].attrs["operators"]) == bool(arguments)
