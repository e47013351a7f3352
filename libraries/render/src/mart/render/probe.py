"""Tell who draws here, by opening the context that every drawing part opens: `python -m mart.render.probe`.

A process of its own, for whoever must not load OpenGL, or not die of a driver. It prints the renderer's name, or the
sentence that says why nothing can be drawn, and ends with 1 then.
"""

from __future__ import annotations

import sys

import mujoco

from mart.protocol.errors import Unavailable
from mart.render.gl_context import open_context

_SIZE_PX = 64
_SCENE = "<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>"


def renderer_name() -> str:
    """Return OpenGL's own name for who draws ("llvmpipe (LLVM 15.0.6, 256 bits)"); raises Unavailable."""
    gl, context = open_context(mujoco.MjModel.from_xml_string(_SCENE), _SIZE_PX, _SIZE_PX)
    from OpenGL import GL  # type: ignore[import-untyped]

    try:
        name = GL.glGetString(GL.GL_RENDERER)
        return name.decode(errors="replace") if name else "an unnamed renderer"
    finally:
        context.free()
        gl.free()


def main() -> int:
    """Print the name, or why there is none; return the exit status."""
    try:
        print(renderer_name())  # noqa: T201
    except Unavailable as error:
        print(error)  # noqa: T201
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
