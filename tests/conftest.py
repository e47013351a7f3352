"""What holds for every test: one of the kinds, no MART_ setting from outside, and slow kinds last."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from mart.runtime import steady_libm
from mart.runtime.ports import free_port
from mart.runtime.router import admitting_router
from tests.support import fuzzing, processes

# Tests in these folders are of the kind of that name; others are unit tests, unless they say `system` themselves.
_FOLDERS = ("contract", "system", "browser", "compose", "lerobot")
_KINDS = ("unit", *_FOLDERS)  # a broken unit explains a broken session, so units run first


def pytest_configure(config: pytest.Config) -> None:
    _begin_anew(config)
    # How long one example takes says more about the machine than about the code.
    for profile in ("mart", fuzzing.PROFILE):
        settings.register_profile(profile, deadline=None)
    settings.load_profile(config.getoption("--hypothesis-profile") or "mart")
    for name in [name for name in os.environ if name.startswith("MART_")]:
        del os.environ[name]
    # As mart.trainer does, which tests import after torch.
    os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
    # Where routers are noted for this user's programs: tests have a place of their own.
    os.environ["XDG_STATE_HOME"] = tempfile.mkdtemp(prefix="mart-tests-")


def pytest_unconfigure() -> None:
    shutil.rmtree(os.environ.pop("XDG_STATE_HOME", ""), ignore_errors=True)


def _begin_anew(config: pytest.Config) -> None:
    """Compute as services do, whose mathematics is the same on every processor: tests compare worlds with theirs."""
    environment = steady_libm.steady_environment(os.environ)
    if environment is not None:
        capture = config.pluginmanager.getplugin("capturemanager")
        if capture is not None:
            capture.stop_global_capturing()
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)


def pytest_make_parametrize_id(val: object, argname: str) -> str | None:
    """Name long bytes by their length: compressed or packed, they may differ between processes.

    Workers that name a test differently collect different tests, and then no test runs at all.
    """
    return f"{argname}_of_{len(val)}_bytes" if isinstance(val, bytes) and len(val) > 16 else None


@pytest.hookimpl(tryfirst=True)  # before `-m` chooses
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        folder = item.path.relative_to(config.rootpath / "tests").parts[0]
        if folder in _FOLDERS:
            item.add_marker(folder)
        elif item.get_closest_marker("system") is None:
            item.add_marker("unit")
    # Files of long tests first: one that begins last would keep the other worker waiting.
    longest_s = Counter[Path]()
    for item in items:
        longest_s[item.path] = max(longest_s[item.path], _timeout_s(item))
    items.sort(key=lambda item: (_rank(item), -longest_s[item.path]))


@pytest.hookimpl(tryfirst=True)  # before fixtures are made
def pytest_runtest_setup(item: pytest.Item) -> None:
    processes.may_start = item.get_closest_marker("unit") is None


def _rank(item: pytest.Item) -> int:
    return next(rank for rank, kind in enumerate(_KINDS) if item.get_closest_marker(kind) is not None)


def _timeout_s(item: pytest.Item) -> int:
    """What a test was given because it takes longer than others; 0 for the others."""
    mark = item.get_closest_marker("timeout")
    return int(mark.args[0]) if mark else 0


@pytest.fixture
def endpoint(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A real router of the test's own, with a secret."""
    address = f"tcp/127.0.0.1:{free_port()}"
    with admitting_router(address, tmp_path_factory.mktemp("router") / "bus"):
        yield address
