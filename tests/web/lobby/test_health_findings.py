"""What the health page says: each problem has its mend, and what is well has none."""

from __future__ import annotations

import asyncio

import pytest

from mart.protocol.messages import Event
from mart.web.api.app_state import AppState
from mart.web.lobby.health_findings import (
    RelayCheck,
    cameras,
    delays,
    machine,
    pictures,
    relays,
    rooms,
    services,
)
from mart.web.lobby.room_json import Json
from tests.web.conftest import Enter
from tests.web.room import Room

EVERYTHING = ("sim", "gateway", "recorder", "replica", "experts", "catalogue", "trainer", "policies")


def a_room(**changes: object) -> Json:
    told = {"room": "room-1", "title": "Lifting", "real_time_factor": 1.0, "stale": False, "slow": False}
    return {**told, "waiting_for": [], "barrier": "running", "stop": None, **changes}


def test_all_is_well_where_everything_runs() -> None:
    known = [
        *services({kind: [f"{kind}-1"] for kind in EVERYTHING}),
        *rooms([a_room()]),
        *machine(50_000_000_000, 300.0),
    ]
    assert [finding.mend for finding in known] == [""] * len(known)


@pytest.mark.parametrize("kind", EVERYTHING)
def test_what_does_not_run_is_named_with_its_command(kind: str) -> None:
    found = list(services({other: ["x"] for other in EVERYTHING if other != kind}))
    missing = [finding for finding in found if finding.found == "not running"]
    assert len(missing) == 1
    assert (f"mart {kind}" in missing[0].mend) == (kind not in ("trainer", "policies"))


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"stale": True}, "does not answer"),
        ({"waiting_for": [{"arm": "arm0", "name": "Ana", "since_s": 1.0}]}, "waits for Ana"),
        ({"real_time_factor": 0.8, "slow": True}, "0.80"),
    ],
)
def test_a_room_that_does_not_do_well(changes: Json, found: str) -> None:
    (finding,) = rooms([a_room(**changes)])
    assert found in finding.found
    assert finding.mend
    (hiccup,) = rooms([a_room(real_time_factor=0.8)])
    assert not hiccup.mend


def slow(stage: str, p50_ms: float = 250.0) -> Event.Latency:
    stages = [Event.Latency.Stage(name=stage, p50_ms=200), Event.Latency.Stage(name="physics", p50_ms=1)]
    return Event.Latency(arm="arm0", p50_ms=p50_ms, p95_ms=413, stages=stages)


@pytest.mark.parametrize(
    ("latency", "load", "mend"),
    [
        (slow("send → displayed"), 0.5, "Use a cable"),
        (slow("input → gateway"), 0.5, "Use a cable"),
        (slow("send → displayed"), 3.0, "This machine is busy"),
        (slow("render"), 0.5, "This machine is busy"),
        (slow("send → displayed", p50_ms=60), 0.5, "Use a cable"),  # now and then it is late
        (Event.Latency(arm="arm0", p50_ms=60, p95_ms=90), 9.0, ""),
    ],
)
def test_the_advice_is_for_the_cause(latency: Event.Latency, load: float, mend: str) -> None:
    (finding,) = delays([("room-1", latency)], load)
    assert finding.mend.startswith(mend)
    assert bool(finding.mend) == bool(mend)


@pytest.mark.parametrize(
    ("drawn_in_page", "draw_ms", "told"),
    [
        (True, 3.0, "drawn in the page, 3 ms a draw, 95 % under 6 ms, 60 a second"),
        (False, 90.0, "video, since the page would need 90 ms a draw"),
        (False, 0.0, ""),
    ],
)
def test_who_draws_is_told_with_the_delay(drawn_in_page: bool, draw_ms: float, told: str) -> None:
    latency = Event.Latency(arm="arm0", p50_ms=60, p95_ms=90, drawn_in_page=drawn_in_page, draws_per_s=60)
    latency.draw_p50_ms, latency.draw_p95_ms = draw_ms, 2 * draw_ms
    (finding,) = delays([("room-1", latency)])
    assert told in finding.found
    assert bool(told) == (";" in finding.found)


def test_a_seat_that_cannot_be_drawn_is_a_finding() -> None:
    missing = Event.NoPicture(arm="arm0", reason="Nothing can be drawn on this machine.")
    (finding,) = pictures([("room-1", missing)])
    assert (finding.name, finding.found) == ("arm0 in room-1, picture", missing.reason)
    assert "mart doctor" in finding.mend


def test_a_dark_camera_is_a_finding_with_its_mend() -> None:
    told = [
        {"camera": "arm0-wrist", "arm": "arm0", "dark": "Its picture is black."},
        {"camera": "table", "arm": "", "dark": ""},
    ]
    dark, well = cameras([a_room(cameras=told)])
    assert (dark.name, dark.found) == ("camera arm0.wrist in room-1", "Its picture is black.")
    assert "lens" in dark.mend
    assert well.mend == ""


def test_a_stopped_room_says_who_stopped_it() -> None:
    (finding,) = rooms([a_room(barrier="stopped", stop={"arm": "", "name": "Ben", "by_host": False})])
    assert finding.found == "stopped by Ben"
    assert "Go on" in finding.mend


def test_a_paused_room_says_that_a_host_lets_it_go_on() -> None:
    (finding,) = rooms([a_room(barrier="stopped", stop={"arm": "", "name": "Hanna", "by_host": True})])
    assert finding.found == "paused by Hanna, the host"
    assert "A host lets it go on" in finding.mend


def test_long_delays_full_disks_and_old_certificates() -> None:
    (late,) = delays([("room-1", slow("send → displayed"))])
    assert "250 ms" in late.found
    assert "send → displayed" in late.mend
    disk, certificate = machine(5_000_000, 3.0)
    assert disk.mend
    assert certificate.mend
    assert list(machine(5, None))[1].found == "cannot be read"


@pytest.mark.anyio
async def test_who_has_joined_sees_it(enter: Enter, room: Room, app_state: AppState) -> None:
    assert (await (await enter()).get("/api/health/findings")).status_code == 401
    room.tell(Event(latency=Event.Latency(arm="arm0", p50_ms=40, p95_ms=60)))
    room.tell(Event(no_picture=Event.NoPicture(arm="arm1", reason="No EGL.")))
    await asyncio.sleep(0)
    told = (await (await enter("Ana")).get("/api/health/findings")).json()["findings"]
    areas = {finding["area"]: finding for finding in told}
    assert [finding["found"] for finding in told if finding["name"] == "arm1 in room-1, picture"] == [
        "No EGL."
    ]
    assert areas["delays"]["found"] == "40 ms typical, 95 % under 60 ms"
    assert "room-1" in areas["rooms"]["name"]
    assert "good for 39" in areas["machine"]["found"]


def test_a_relay_that_gives_nothing_is_a_finding() -> None:
    asked = {
        "stun:a.org": RelayCheck(True, "sees us at 10.0.0.7"),
        "turn:b.org": RelayCheck(False, "turn:b.org refuses the credentials."),
    }
    well, amiss = relays(asked)
    assert (well.found, well.mend) == ("stun:a.org sees us at 10.0.0.7", "")
    assert amiss.found == "turn:b.org refuses the credentials."
    assert "MART_ICE_SERVERS" in amiss.mend
