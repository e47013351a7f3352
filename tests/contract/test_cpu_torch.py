"""Which PyTorch `tools/cpu-torch` installs, with a Python and a uv that only write down what they are asked."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.contract.repository import ROOT

# Stands for the environment's Python: tells which PyTorch is installed, and installs a uv that fails on demand.
_PYTHON = """#!/usr/bin/env bash
echo "python $*" >>"$RECORD"
if [ "$1" = -c ]; then [ -n "$INSTALLED" ] && echo "torch==$INSTALLED"; exit; fi
[ -z "$NO_UV" ] || exit 1
while [ "$1" != --target ]; do shift; done
mkdir "$2/bin"
cat >"$2/bin/uv" <<'UV'
#!/usr/bin/env bash
echo "uv $*" >>"$RECORD"
[[ "$*" != *"$UV_FAILS_AT" ]]
UV
chmod +x "$2/bin/uv"
"""


@dataclass(frozen=True)
class Machine:
    folder: Path

    def install(self, *options: str, **environment: str) -> tuple[list[str], str]:
        """What pip and uv were told to install, and what was said."""
        record = self.folder / "record"
        record.touch()
        settings = {
            "PATH": f"{self.folder}:/usr/bin:/bin",
            "RECORD": str(record),
            "NVIDIA_DRIVER": str(self.folder / "version"),
            **dict.fromkeys(("INSTALLED", "NO_UV"), ""),
            "UV_FAILS_AT": "never",
            **environment,
        }
        files = (self.folder / "python", self.folder / "constraints.txt")
        words = [str(ROOT / "tools" / "cpu-torch"), *options, *map(str, files)]
        done = subprocess.run(words, env=settings, capture_output=True, text=True, check=True)
        return [line for line in record.read_text().splitlines() if " install " in line], done.stderr

    def program(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)
        (self.folder / name).chmod(0o755)


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    machine = Machine(tmp_path)
    machine.program("python", _PYTHON)
    machine.program("nvidia-smi", "#!/bin/sh\nexit 9\n")  # as it ends where the driver finds no GPU
    (tmp_path / "constraints.txt").write_text("torch==2.13.0\nuv==0.13.9\n")
    return machine


def test_without_a_gpu_the_cpu_build_is_asked_for_and_installed(machine: Machine) -> None:
    (pip, asked, installed), said = machine.install()
    assert pip.endswith(f"--constraint {machine.folder}/constraints.txt uv")
    assert "--torch-backend cpu --no-deps torch==2.13.0" in installed
    assert asked == f"{installed} --dry-run"
    assert said == ""


@pytest.mark.parametrize(
    ("trouble", "tries"),
    [({"NO_UV": "yes"}, 1), ({"UV_FAILS_AT": "--dry-run"}, 2), ({"UV_FAILS_AT": "torch==2.13.0"}, 3)],
)
def test_where_it_cannot_be_had_one_sentence_leaves_it_to_pip(
    machine: Machine, trouble: dict[str, str], tries: int
) -> None:
    installed, said = machine.install(**trouble)
    assert len(installed) == tries
    assert said.count("\n") == 1
    assert "pip takes the build that it finds" in said


@pytest.mark.parametrize("installed", ["2.13.0", "2.13.0+cpu"])
def test_what_is_there_stays(machine: Machine, installed: str) -> None:
    assert machine.install(INSTALLED=installed) == ([], "")


def test_another_version_is_replaced(machine: Machine) -> None:
    installed, _ = machine.install(INSTALLED="2.13.01")
    assert len(installed) == 3


@pytest.mark.parametrize("sign", ["nvidia-smi", "driver"])
def test_with_a_gpu_it_is_left_to_pip(machine: Machine, sign: str) -> None:
    if sign == "driver":
        (machine.folder / "version").touch()
    else:
        machine.program("nvidia-smi", "#!/bin/sh\n")
    assert machine.install() == ([], "")
    assert len(machine.install("--always")[0]) == 3  # for a container, which is lent no GPU
