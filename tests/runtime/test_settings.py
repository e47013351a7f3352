"""Settings from options and the environment; what is not allowed is said in one sentence."""

from __future__ import annotations

import pytest
from pydantic import Field

from mart.protocol.errors import InvalidInput
from mart.runtime.settings import Settings


class RateSettings(Settings):
    rate_hz: float = Field(20.0, ge=5.0)


def test_an_option_goes_before_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MART_RATE_HZ", "30")
    assert RateSettings().rate_hz == 30.0
    assert RateSettings(rate_hz=60.0).rate_hz == 60.0


def test_a_value_that_is_not_allowed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidInput, match=r"rate_hz = 1\.0 was given.*greater than or equal to 5"):
        RateSettings(rate_hz=1.0)
    monkeypatch.setenv("MART_RATE_HZ", "fast")
    with pytest.raises(InvalidInput, match=r"'fast' was given.*MART_RATE_HZ"):
        RateSettings()


class ArmSettings(Settings):
    arm_name: str


def test_what_was_not_given_is_asked_for() -> None:
    with pytest.raises(
        InvalidInput, match=r"^--arm-name is missing; give it, or set MART_ARM_NAME\. See --help\.$"
    ):
        ArmSettings(data_dir="data")


@pytest.mark.parametrize(
    "given", ["", "lab", "tcp/lab", "tcp/lab:", "tcp/lab:99999", "tcp/lab:0", "http://lab:7447"]
)
def test_a_router_that_cannot_be_one_is_named(monkeypatch: pytest.MonkeyPatch, given: str) -> None:
    monkeypatch.setenv("MART_ROUTER", given)
    with pytest.raises(InvalidInput, match="tcp/HOST:PORT"):
        Settings()


def test_routers_may_be_other_than_tcp() -> None:
    for given in ("tls/lab.org:7447", "tcp/[::1]:7447", "unixsock-stream//run/mart.sock"):
        assert Settings(router=given).router == given
