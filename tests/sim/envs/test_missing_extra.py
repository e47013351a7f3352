"""The environments are an extra of the sim: without it, whoever asks for them is told what to install."""

from __future__ import annotations

import importlib
import sys

import pytest

from mart.protocol.errors import Unavailable


@pytest.mark.parametrize("missing", ["gymnasium", "pettingzoo", "mart.render"])
def test_an_installation_without_the_extra_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    for name in [name for name in sys.modules if name.startswith("mart.sim.envs")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(Unavailable, match=r"mart-sim\[envs\]"):
        importlib.import_module("mart.sim.envs")
