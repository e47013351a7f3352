"""Choose where networks are computed, and in which numbers."""

from __future__ import annotations

import re

import torch

from mart.protocol.errors import InvalidInput, Unavailable

_ALLOWED = re.compile(r"cpu|cuda(:\d{1,3})?|auto")


def find_device(name: str) -> torch.device:
    """Return the device of a name: `cpu`, `cuda`, `cuda:N`, or `auto`, a GPU where there is one.

    Raises InvalidInput and Unavailable.
    """
    if not _ALLOWED.fullmatch(name):
        raise InvalidInput(f"The device {name!r} was given; use cpu, cuda, cuda:N or auto.")
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    device = torch.device(name)
    if device.type == "cuda" and (device.index or 0) >= torch.cuda.device_count():
        raise Unavailable(
            f"The device {name!r} was asked for, but there are {torch.cuda.device_count()} GPUs here; use cpu."
        )
    return device


def product_dtype(device: torch.device, precision: str = "auto") -> torch.dtype:
    """Return the type of matrix products. precision: float32, bfloat16, or auto: what is fastest."""
    if precision != "auto":
        return {"float32": torch.float32, "bfloat16": torch.bfloat16}[precision]
    if device.type == "cuda":
        has = torch.cuda.is_bf16_supported(including_emulation=False)
    else:
        has = bool(torch.cpu.get_capabilities().get("avx512_bf16"))
    return torch.bfloat16 if has else torch.float32
