"""Compares wheels with the repository: `check_wheels.py FOLDER` fails where one lacks or adds a file of its part."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

from packaging.utils import NormalizedName, canonicalize_name, parse_wheel_filename

ROOT = Path(__file__).resolve().parents[1]
COMPILED = (".c", ".so")  # sources of what is compiled stay outside, its machine code is built


def main(folder: Path) -> int:
    """Print what differs, a line each; 1 where anything does."""
    wheels = {parse_wheel_filename(path.name)[0]: path for path in folder.glob("*.whl")}
    complaints = [complaint for part in _parts() for complaint in _compare(part, wheels)]
    sys.stderr.write("".join(f"{complaint}\n" for complaint in complaints))
    sys.stdout.write("".join(f"{path}\n" for path in sorted(wheels.values())))
    return 1 if complaints else 0


def _parts() -> list[Path]:
    return [ROOT / Path(name).parent for name in _tracked("*/pyproject.toml")]


def _compare(part: Path, wheels: dict[NormalizedName, Path]) -> list[str]:
    name = canonicalize_name(tomllib.loads((part / "pyproject.toml").read_text())["project"]["name"])
    if name not in wheels:
        return [f"{name} has no wheel."]
    source = f"{part.relative_to(ROOT)}/src/"
    wanted = {path.removeprefix(source) for path in _tracked(f"{source}*") if not path.endswith(COMPILED)}
    with ZipFile(wheels[name]) as wheel:
        names = (path for path in wheel.namelist() if ".dist-info/" not in path)
        held = {path for path in names if not path.endswith(COMPILED)}
    missing = [f"{wheels[name].name} lacks {path}" for path in sorted(wanted - held)]
    return missing + [
        f"{wheels[name].name} has {path}, which git does not know" for path in sorted(held - wanted)
    ]


def _tracked(pattern: str) -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files", pattern], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return listed.stdout.splitlines()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
