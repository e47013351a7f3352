from __future__ import annotations

from pathlib import Path

import pytest

from mart.driver.loading import load_driver
from mart.driver.simulated import SimulatedArm
from mart.protocol.errors import InvalidInput
from tests.contract.repository import ROOT

EXAMPLE = str(ROOT / "examples" / "08_driver_of_your_own.py")


def test_a_driver_is_found_in_a_module_with_its_options() -> None:
    driver = load_driver(
        "mart.driver.simulated:SimulatedArm", {"address": "127.0.0.1:9", "kind": "ur5e", "joints": "6"}
    )
    assert isinstance(driver, SimulatedArm)
    assert (driver.kind, driver.joint_count) == ("ur5e", 6)


def test_a_driver_is_found_in_a_file_and_the_example_is_one() -> None:
    driver = load_driver(f"{EXAMPLE}:ToyArm", {"slow": "yes"})
    driver.connect()
    before = driver.read()
    driver.servo(before.joint_positions + 0.1, 1.0)
    assert driver.read().joint_positions == pytest.approx(before.joint_positions + 0.01)
    driver.stop()
    driver.close()


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("SimulatedArm", {}),
        ("mart.driver.simulated:Simulated Arm", {}),
        ("mart.driver.nowhere:Arm", {}),
        ("mart.driver.limits:MotionLimits", {}),
        ("mart.driver.simulated:SimulatedArm", {}),
        ("mart.driver.simulated:SimulatedArm", {"address": "here"}),
        (f"{EXAMPLE}:ToyArm", {"fast": "yes"}),
        ("nowhere.py:Arm", {}),
    ],
)
def test_what_is_no_driver_is_refused_in_a_sentence(name: str, options: dict[str, str]) -> None:
    with pytest.raises(InvalidInput) as refused:
        load_driver(name, options)
    assert str(refused.value).endswith((".", "help"))


def test_a_driver_that_does_not_say_its_rate_is_refused(tmp_path: Path) -> None:
    text = Path(EXAMPLE).read_text().replace("rate_hz = ", "pace_hz = ")
    (tmp_path / "other.py").write_text(text)
    with pytest.raises(InvalidInput):
        load_driver(f"{tmp_path}/other.py:ToyArm", {})
