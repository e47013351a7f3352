"""What a checkpoint takes and gives is read from the JSON beside it; what does not fit is told before it is loaded."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from mart.lerobot_policies.checkpoint import read_checkpoint
from mart.lerobot_policies.loader import load
from mart.protocol.errors import Corrupt, MartError, NotFound, Unavailable

ARMS = ("arm0", "arm1")
ACTION = [f"{arm}/action/{index}" for arm in ARMS for index in range(7)]
FACTS = {"task": "two_arm_multi_cube_lifting", "control_hz": 20.0, "arms": ARMS}
INFO: Mapping[str, Any] = {
    "fps": 20,
    "features": {
        "observation.state": {
            "dtype": "float32",
            "shape": [2],
            "names": ["arm0/gripper/0", "arm1/gripper/0"],
        },
        "observation.images.front": {
            "dtype": "video",
            "shape": [64, 96, 3],
            "names": ["height", "width", "channels"],
        },
        "action": {"dtype": "float32", "shape": [14], "names": ACTION},
        "index": {"dtype": "int64", "shape": [1], "names": None},
    },
}
CONFIG: Mapping[str, Any] = {
    "type": "act",
    "input_features": {
        "observation.state": {"type": "STATE", "shape": [2]},
        "observation.images.front": {"type": "VISUAL", "shape": [3, 64, 96]},
    },
    "output_features": {"action": {"type": "ACTION", "shape": [14]}},
}


def write(folder: Path, config: object = CONFIG, info: object = INFO, facts: object = FACTS) -> Path:
    """A checkpoint whose data set is described beside it; what is None is left out."""
    folder.mkdir(exist_ok=True)
    (folder / "model.safetensors").write_bytes(b"")
    for name, said in (("config.json", config), ("info.json", info), ("mart.json", facts)):
        if said is not None:
            (folder / name).write_text(json.dumps(said))
    return folder


def test_it_is_told_number_by_number(tmp_path: Path) -> None:
    found = read_checkpoint(write(tmp_path / "beside"))
    assert found.numbers == {"observation.state": ("arm0/gripper/0", "arm1/gripper/0")}
    assert found.pictures == {"observation.images.front": (64, 96)}
    assert (found.kind, found.facts.task, found.facts.arms) == ("act", FACTS["task"], ARMS)


def test_the_data_set_of_the_training_is_found(tmp_path: Path) -> None:
    meta = tmp_path / "set" / "meta"
    meta.mkdir(parents=True)
    (meta / "info.json").write_text(json.dumps(INFO))
    (meta / "mart.json").write_text(json.dumps(FACTS))
    folder = write(tmp_path / "checkpoint", info=None, facts=None)
    with pytest.raises(NotFound, match=r"copy `meta/info\.json` and `meta/mart\.json`"):
        read_checkpoint(folder)
    (folder / "train_config.json").write_text(json.dumps({"dataset": {"root": str(tmp_path / "set")}}))
    assert read_checkpoint(folder).facts.control_hz == 20.0


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("config", {}),
        ("config", [1]),
        ("config", {**CONFIG, "output_features": {"action": {"type": "ACTION", "shape": [7]}}}),
        ("config", {**CONFIG, "input_features": {"observation.state": {"type": "STATE", "shape": [3]}}}),
        ("config", {**CONFIG, "input_features": {"observation.elbow": {"type": "STATE", "shape": [2]}}}),
        ("info", {"features": {}}),
        ("facts", {**FACTS, "arms": ["arm0"]}),
        ("facts", {**FACTS, "control_hz": -1}),
        ("facts", {"task": 3}),
    ],
)
def test_what_does_not_fit_is_one_sentence(tmp_path: Path, what: str, said: object) -> None:
    given = {"config": CONFIG, "info": INFO, "facts": FACTS, what: said}
    with pytest.raises(Corrupt) as caught:
        read_checkpoint(write(tmp_path / "spoilt", **given))
    assert "\n" not in str(caught.value)


def test_other_folders_are_left_to_others(tmp_path: Path) -> None:
    assert load(tmp_path, "cpu") is None


def test_where_lerobot_is_not_installed_it_says_so(tmp_path: Path) -> None:
    with pytest.raises(Unavailable, match="LeRobot's environment"):
        load(write(tmp_path / "checkpoint"), "cpu")


def test_whatever_loads_policies_finds_it(tmp_path: Path) -> None:
    from mart.policies import load_policy

    with pytest.raises(Unavailable, match="LeRobot's environment"):
        load_policy(write(tmp_path / "checkpoint"))
    with pytest.raises(MartError, match="checkpoint"):
        load_policy(tmp_path)
