"""Find the Panda's link meshes in the installed gymnasium-robotics wheel (Franka Emika's, Apache-2.0)."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from mart.protocol.errors import Unavailable

# hull: convex hulls of 200 to 300 triangles a link, 8 ms a frame in software OpenGL. detailed: 7,000 to 22,000
# triangles a link, for machines with a GPU.
Detail = Literal["hull", "detailed"]

_FOLDER = Path("envs", "assets", "kitchen_franka", "franka_assets", "meshes")


def mesh_path(part: str, detail: Detail) -> Path:
    """Return the file of a part (link0 … link7, hand, finger); raises Unavailable without the wheel."""
    # find_spec does not run the package: importing it would pull in gymnasium and register environments.
    package = find_spec("gymnasium_robotics")
    if package is None or package.origin is None:
        raise Unavailable("The Panda's meshes are missing: pip install gymnasium-robotics.")
    path = (
        Path(package.origin).parent
        / _FOLDER
        / ("collision" if detail == "hull" else "visual")
        / f"{part}.stl"
    )
    if not path.is_file():
        raise Unavailable(
            f"{path} is missing: install the gymnasium-robotics version named in constraints.txt."
        )
    return path
