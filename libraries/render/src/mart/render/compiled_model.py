"""Load a compiled model as it travels on the bus and in episode files, and find its cameras."""

from __future__ import annotations

import hashlib

import mujoco

from mart.protocol.errors import Corrupt, NotFound
from mart.render.model_probe import objection_to

_FILE = "model.mjb"  # MuJoCo wants a name, also for what is in memory


def load_model(mjb: bytes, *, sha256: str, mujoco_version: str, source: str) -> mujoco.MjModel:
    """Return the compiled model in `mjb`, once its digest is found right.

    `sha256` is its digest in hexadecimal, `mujoco_version` the version that compiled it, `source` where it came from,
    in words for the errors. Raises Corrupt where the digest is another, or this version of MuJoCo cannot load it; what
    would crash it is tried elsewhere first (`model_probe`).
    """
    if hashlib.sha256(mjb).hexdigest() != sha256:
        raise Corrupt(
            f"The model of {source} ({len(mjb)} bytes) does not match its SHA-256: it was changed on its way."
        )
    objection = objection_to(mjb, sha256)
    if objection:
        raise Corrupt(
            f"The model of {source} is of MuJoCo {mujoco_version}; {mujoco.__version__} {objection}. It is not used."
        )
    try:
        return mujoco.MjModel.from_binary_path(_FILE, {_FILE: mjb})
    except ValueError as error:
        raise Corrupt(
            f"The model of {source} is of MuJoCo {mujoco_version}; {mujoco.__version__} cannot load it: {error}"
        ) from error


def viewpoint_id(model: mujoco.MjModel, viewpoint: str) -> int:
    """Return the index of the camera of this name; raises NotFound, which names those that exist."""
    camera: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, viewpoint)
    if camera < 0:
        raise NotFound.named("viewpoint", viewpoint, (model.camera(i).name for i in range(model.ncam)))
    return camera
