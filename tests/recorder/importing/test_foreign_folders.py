"""Folders of LeRobot's that others have made, whole, in half and hostile."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from mart.episodes.reader import open_episode
from mart.protocol.errors import Corrupt
from mart.recorder.importing.foreign_episode import NotImported
from mart.recorder.importing.import_episodes import Imported
from tests.recorder.importing import sources

ACTIONS = np.arange(40.0).reshape(8, 5) / 10
SEEN = np.arange(24.0).reshape(8, 3)
FRAMES: dict[str, Any] = {"observation.state": SEEN, "action": ACTIONS}


def test_lerobot_of_others_in_joint_space(tmp_path: Path) -> None:
    frames = {"observation.state": SEEN.astype(np.float32), "action": ACTIONS.astype(np.float32)}
    sources.write_folder(tmp_path / "fold", frames, [3, 5])
    first, second = sources.imported(tmp_path / "fold", tmp_path / "in")
    assert isinstance(first, Imported)
    assert isinstance(second, Imported)
    assert (first.ticks, second.ticks) == (2, 4)
    data = open_episode(second.path).arrays()
    np.testing.assert_array_equal(data.observations["action"], ACTIONS[3:].astype(np.float32))
    np.testing.assert_array_equal(data.observations["observation.state"], SEEN[3:])
    assert open_episode(second.path).metadata["mart.origin"]["instruction"] == "fold it"


@pytest.mark.parametrize(
    ("info", "sentence"),
    [
        ({"codebase_version": "v2.1"}, "v2.1"),
        ({"data_path": "../../{chunk_index}.parquet"}, "no other path"),
        ({"features": []}, "columns"),
        ({"fps": -1}, "frames a second"),
        ({"features": {"action": {"dtype": "float64", "shape": [10**9]}}}, "shape"),
    ],
)
def test_info_that_cannot_be_used(info: dict[str, Any], sentence: str, tmp_path: Path) -> None:
    sources.write_folder(tmp_path / "fold", FRAMES, [8], info=info)
    try:
        said = " ".join(
            one.why
            for one in sources.imported(tmp_path / "fold", tmp_path / "in")
            if isinstance(one, NotImported)
        )
    except Corrupt as error:
        said = str(error)
    assert sentence in said
    assert not list((tmp_path / "in").rglob("*.mcap*"))


def test_no_path_leads_out_of_the_folder(tmp_path: Path) -> None:
    sources.write_folder(tmp_path / "fold", FRAMES, [8])
    inside = tmp_path / "fold/data/chunk-000/file-000.parquet"
    inside.rename(tmp_path / "elsewhere.parquet")
    inside.symlink_to(tmp_path / "elsewhere.parquet")
    with pytest.raises(Corrupt, match="leads out"):
        sources.imported(tmp_path / "fold", tmp_path / "in")


def test_half_a_data_set(tmp_path: Path) -> None:
    sources.write_folder(tmp_path / "fold", FRAMES, [3, 5])
    table = tmp_path / "fold/data/chunk-000/file-000.parquet"
    pq.write_table(pq.read_table(table).slice(0, 5), table)  # the second has but two of its five frames
    first, second = sources.imported(tmp_path / "fold", tmp_path / "in")
    assert isinstance(first, Imported)
    assert isinstance(second, NotImported)
    assert "2 frames" in second.why
    pq.write_table(pq.read_table(table).slice(0, 3), table)
    _, missing = sources.imported(tmp_path / "fold", tmp_path / "other")
    assert isinstance(missing, NotImported)
    assert "half a data set" in missing.why


@pytest.mark.parametrize("content", [b"", b"PAR1 and nothing", b"PAR1" + bytes(64) + b"PAR1"])
def test_what_is_no_parquet(content: bytes, tmp_path: Path) -> None:
    sources.write_folder(tmp_path / "fold", FRAMES, [8])
    (tmp_path / "fold/data/chunk-000/file-000.parquet").write_bytes(content)
    report = sources.imported(tmp_path / "fold", tmp_path / "in")
    assert all(isinstance(one, NotImported) for one in report)
    assert "no Parquet file" in report[0].why  # type: ignore[union-attr]


def test_columns_that_are_missing_or_of_other_types(tmp_path: Path) -> None:
    sources.write_folder(tmp_path / "fold", FRAMES, [8])
    table = tmp_path / "fold/data/chunk-000/file-000.parquet"
    whole = pq.read_table(table)
    for changed, sentence in (
        (whole.drop(["action"]), "lacks the columns action"),
        (
            whole.set_column(whole.schema.get_field_index("action"), "action", pa.array(["x"] * 8)),
            "numbers are wanted",
        ),
        (
            whole.set_column(whole.schema.get_field_index("action"), "action", pa.array([[1.0]] * 8)),
            "5 numbers",
        ),
    ):
        pq.write_table(changed, table)
        told = sources.imported(tmp_path / "fold", tmp_path / "in")
        assert isinstance(told[0], NotImported)
        assert sentence in told[0].why
