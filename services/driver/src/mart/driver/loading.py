"""Find the class of a driver by its name, and construct it with what the command line gave."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

from mart.driver.interface import Driver
from mart.protocol.errors import InvalidInput

_MAX_RATE_HZ = 1000.0


def load_driver(name: str, options: Mapping[str, str]) -> Driver:
    """Return a driver of the class `module:Class` or `file.py:Class`, constructed with `options`.

    Modules are found as Python finds them, and in the present folder. Raises InvalidInput, with what is wrong.
    """
    module_name, _, class_name = name.rpartition(":")
    if not module_name or not class_name.isidentifier():
        raise InvalidInput(f"The driver {name!r} was given; write module:Class or file.py:Class.")
    found = getattr(_module(module_name), class_name, None)
    if not (isinstance(found, type) and issubclass(found, Driver)):
        raise InvalidInput(f"{module_name} has no class {class_name!r} that is a mart.driver.Driver.")
    try:
        driver = found(**options)
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"{class_name} cannot be made with {dict(options)}: {error}.") from error
    _check(driver, class_name)
    return driver


def _module(name: str) -> ModuleType:
    try:
        if not name.endswith(".py"):
            if "" not in sys.path:
                sys.path.insert(0, "")
            return importlib.import_module(name)
        spec = importlib.util.spec_from_file_location(Path(name).stem, name)
        assert spec is not None  # of a name that ends in .py
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except (ImportError, OSError, SyntaxError) as error:
        raise InvalidInput(f"The driver's module {name!r} cannot be loaded: {error}.") from error
    return module


def _check(driver: Driver, class_name: str) -> None:
    for attribute, kind in (("kind", str), ("joint_count", int), ("rate_hz", (int, float))):
        if not isinstance(getattr(driver, attribute, None), kind):
            raise InvalidInput(f"{class_name} must say its `{attribute}`; see mart.driver.Driver.")
    if not 10.0 <= driver.rate_hz <= _MAX_RATE_HZ:
        raise InvalidInput(f"{class_name} has a servo rate of {driver.rate_hz:g} Hz; 10 to 1000 are allowed.")
