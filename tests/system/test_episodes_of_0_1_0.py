"""Episodes that version 0.1.0 recorded are listed, verified, learned from, exported and drawn as it did that itself.

Nothing of MART is imported but the tests' own support: what is compared went through the command line and through files
that other projects read. What 0.1.0 said is in expected.json; a later version may say more, and nothing else.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import av
import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray
from safetensors.numpy import load_file

from tests.support.processes import running_router, running_service

_MART = Path(sys.executable).with_name("mart")
_LIMIT_S = 100.0
_FIXTURE = Path(__file__).parents[1] / "fixtures" / "episodes_0_1_0"
EXPECTED = json.loads((_FIXTURE / "expected.json").read_text())
EPISODES = ("live", "lockstep", "policy")


class Episodes:
    """The three episodes in a folder of their own, as they were recorded or with what was said about them since."""

    def __init__(self, root: Path) -> None:
        self.root, self.folder = root, root / "episodes"
        with tarfile.open(_FIXTURE / "episodes.tar.xz") as archive:
            for member in archive:
                file = archive.extractfile(member)
                assert file is not None
                path = self.folder / member.name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(file.read())

    def label(self) -> None:
        (self.folder / "labels.jsonl").write_bytes((_FIXTURE / "labels.jsonl").read_bytes())

    def path(self, episode: str) -> Path:
        return self.folder / "2026-11-29" / f"{episode}.mcap"

    def mart(self, *command: str | Path, router: str = "") -> dict[str, Any]:
        """What `mart COMMAND --json` prints, paths relative to the folder of the test."""
        own = {"MART_DATA_DIR": str(self.root / "data")} | ({"MART_ROUTER": router} if router else {})
        ended = subprocess.run(
            [str(_MART), *map(str, command), "--json"],
            capture_output=True,
            text=True,
            timeout=_LIMIT_S,
            env={name: value for name, value in os.environ.items() if not name.startswith("MART_")} | own,
            check=False,
        )
        assert ended.returncode == 0, ended.stderr
        found: dict[str, Any] = json.loads(ended.stdout.replace(f"{self.root}/", ""))
        return found


@pytest.fixture
def recorded(tmp_path: Path) -> Episodes:
    return Episodes(tmp_path)


@pytest.fixture
def labelled(tmp_path: Path) -> Episodes:
    episodes = Episodes(tmp_path)
    episodes.label()
    return episodes


def said_before(found: Any, expected: Any) -> Any:
    """`found` without the keys that 0.1.0 did not have."""
    if isinstance(found, dict) and isinstance(expected, dict):
        return {key: said_before(value, expected[key]) for key, value in found.items() if key in expected}
    if isinstance(found, list) and isinstance(expected, list) and len(found) == len(expected):
        return [said_before(one, other) for one, other in zip(found, expected, strict=True)]
    return found


def assert_said(found: Any, *keys: str) -> None:
    """`keys` lead to what 0.1.0 said in expected.json."""
    expected = EXPECTED
    for key in keys:
        expected = expected[key]
    assert said_before(found, expected) == expected


def digest_of(array: NDArray[Any]) -> str:
    """Type, shape and a hash of the numbers."""
    numbers = np.ascontiguousarray(array)
    assert sys.byteorder == "little"
    return f"{numbers.dtype}{list(numbers.shape)} {hashlib.sha256(numbers.tobytes()).hexdigest()[:32]}"


def test_they_are_listed(recorded: Episodes) -> None:
    assert_said(recorded.mart("episodes", "list", recorded.folder)["episodes"], "list", "recorded")


def test_they_are_listed_with_what_was_said_about_them(labelled: Episodes) -> None:
    assert_said(labelled.mart("episodes", "list", labelled.folder)["episodes"], "list", "labelled")


def test_their_records_are_shown(recorded: Episodes) -> None:
    for episode in EPISODES:
        shown = recorded.mart("episodes", "show", recorded.path(episode))
        assert_said(shown["metadata"], "metadata", episode)


def test_their_data_set_holds_what_it_held(labelled: Episodes) -> None:
    assert_said(labelled.mart("datasets", "list", "--folder", labelled.folder), "data set", "list")
    assert_said(labelled.mart("datasets", "show", "lifts", "--folder", labelled.folder), "data set", "show")


@pytest.fixture
def router(tmp_path: Path) -> Iterator[str]:
    """With a replica, which steps worlds again."""
    with (
        running_router() as endpoint,
        running_service(["replica"], endpoint, tmp_path / "data", kind="replica", id="replica-1"),
    ):
        yield endpoint


def test_they_follow_bit_for_bit(recorded: Episodes, router: str) -> None:
    found = recorded.mart("episodes", "verify", recorded.folder, router=router)["episodes"]
    assert_said(sorted(found, key=lambda one: str(one["path"])), "verify")


def test_they_are_exported_for_robomimic(recorded: Episodes) -> None:
    said = export(recorded, "robomimic", "any")
    with h5py.File(recorded.root / said["path"]) as file:
        arrays: dict[str, str] = {}

        def visit(name: str, one: Any) -> None:
            if isinstance(one, h5py.Dataset) and not name.startswith("mask/"):
                arrays[name] = digest_of(one[()])

        file.visititems(visit)
        told = {"said": said, "arrays": arrays, "masks": masks(file), "attributes": attributes(file)}
    assert_said(told, "robomimic", "recorded")


def test_they_are_exported_as_they_were_labelled(labelled: Episodes) -> None:
    said = export(labelled, "robomimic")
    with h5py.File(labelled.root / said["path"]) as file:
        told = {"said": said, "masks": masks(file), "attributes": attributes(file)}
    assert_said(told, "robomimic", "labelled")


def export(episodes: Episodes, file_format: str, *outcome: str) -> dict[str, Any]:
    wanted = ["--with-names", *(word for one in outcome for word in ("--outcome", one))]  # as 0.1.0 did
    out = episodes.root / "exported"
    return episodes.mart(
        "episodes", "export", episodes.folder, "--format", file_format, "--out", out, *wanted
    )


def masks(file: h5py.File) -> dict[str, list[str]]:
    return {name: [demo.decode() for demo in demos[()]] for name, demos in file["mask"].items()}


def attributes(file: h5py.File) -> dict[str, dict[str, Any]]:
    """Of the data and of every demonstration; those that are JSON, as what they say."""
    data = file["data"]
    groups = {"data": data.attrs} | {name: demo.attrs for name, demo in data.items()}
    return {name: {key: plain(value) for key, value in attrs.items()} for name, attrs in groups.items()}


def plain(value: Any) -> Any:
    """An attribute as JSON has it."""
    if not isinstance(value, str):
        return value.item()
    return json.loads(value) if value.startswith(("{", "[")) else value


def test_they_are_exported_for_lerobot(recorded: Episodes) -> None:
    said = export(recorded, "lerobot", "any")
    folder = recorded.root / said["path"]
    table = pq.read_table(folder / "data/chunk-000/file-000.parquet")
    told = {
        "said": said,
        "rows": table.num_rows,
        "columns": {name: digest_of(np.array(table[name].to_pylist())) for name in table.column_names},
        "episodes": pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist(),
        "info": json.loads((folder / "meta/info.json").read_text()),
    }
    assert_said(told, "lerobot")


def train(episodes: Episodes, *options: str | Path) -> dict[str, Any]:
    """One update in float32, so that no processor's rounding hides what was learned from."""
    sizes = [word for one in ("updates=1", "checkpoints=1", "precision=float32") for word in ("--set", one)]
    out = episodes.root / "run"
    said = episodes.mart("train", "--model", "d-HBC", "--preset", "debug", *sizes, "--out", out, *options)
    data = json.loads((out / "data.json").read_text().replace(f"{episodes.root}/", ""))
    return {"said": said, "data": data}


def test_they_are_learned_from(recorded: Episodes) -> None:
    told = train(recorded, "--data", recorded.folder, "--outcome", "any", "--verdict", "verified")
    read = [load_file(path) for path in (recorded.root / "data/cache/episodes").glob("*.safetensors")]
    learned = ("observations", "actions", "sources")
    told["arrays"] = sorted(digest_of(arrays[name]) for arrays in read for name in learned)
    assert_said(told, "train", "recorded")
    first = json.loads((recorded.root / "run/metrics.jsonl").read_text().splitlines()[0])
    losses = EXPECTED["train"]["losses"]
    assert {name: first[name] for name in losses} == pytest.approx(losses, rel=1e-3)


def test_their_data_set_is_learned_from(labelled: Episodes) -> None:
    told = train(labelled, "--data", labelled.folder, "--dataset", "lifts")
    assert_said(told, "train", "labelled")


@pytest.mark.parametrize(
    ("episode", "viewpoint"), [("live", "front"), ("lockstep", "arm0"), ("policy", "arm1")]
)
def test_they_are_drawn(recorded: Episodes, episode: str, viewpoint: str) -> None:
    size = ["--width", "160", "--height", "120", "--viewpoint", viewpoint]
    out = recorded.root / f"{episode}.mp4"
    said = recorded.mart("episodes", "render", recorded.path(episode), "--out", out, *size)
    with av.open(out) as video:
        rate = video.streams.video[0].average_rate
        pictures = [frame.to_ndarray(format="gray") for frame in video.decode(video=0)]
    assert_said({"said": said, "pictures": len(pictures), "rate": str(rate)}, "render", episode)
    seen = [brightness(picture) for picture in (pictures[0], pictures[-1])]
    # Another renderer shades a little differently.
    assert np.abs(np.subtract(seen, EXPECTED["brightness"][episode])).max() <= 8


def brightness(picture: NDArray[Any]) -> list[list[int]]:
    """Of the picture's tiles of 40 x 40 pixels, 0 … 255."""
    assert picture.shape == (120, 160)
    tiles: list[list[int]] = picture.reshape(3, 40, 4, 40).mean(axis=(1, 3)).round().astype(int).tolist()
    return tiles
