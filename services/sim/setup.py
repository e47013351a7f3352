"""Only what pyproject.toml cannot say: osc.c needs the headers inside the installed mujoco-core."""

from importlib.util import find_spec
from pathlib import Path

from setuptools import Extension, setup

mujoco = find_spec("mujoco")
if mujoco is None or mujoco.origin is None:
    raise SystemExit("mart-sim compiles against mujoco-core's headers: pip install mujoco-core first.")

# The loops run over 3, 6 and 7 elements, so most of the time goes to counting unless they are unrolled. Contraction
# to fused multiply-add stays off: results must not depend on what the compiler happens to fuse.
FLAGS = [
    "-O2",
    "-std=c11",
    "-funroll-loops",
    "-fpeel-loops",
    *("--param", "max-completely-peel-times=64"),
    *("--param", "max-completely-peeled-insns=2000"),
    "-ffp-contract=off",
    "-fno-math-errno",
]

setup(
    ext_modules=[
        Extension(
            "mart.sim.world._osc",
            sources=["src/mart/sim/world/osc.c"],
            depends=["src/mart/sim/world/small_matrices.h"],
            include_dirs=[str(Path(mujoco.origin).parent / "include")],
            libraries=["m"],
            extra_compile_args=FLAGS,
        )
    ]
)
