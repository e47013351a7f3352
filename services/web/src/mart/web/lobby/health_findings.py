"""How everything does, in words, each problem with its mend. Pure: what is known in, findings out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from mart.protocol.cameras import camera_title
from mart.protocol.messages import Event
from mart.protocol.vocabulary import ServiceKind
from mart.web.lobby.room_json import Json

LATE_MS = 200.0  # from hand to picture: above it, people lose speed
LATE_P95_MS = 400.0
BUSY_LOAD = 1.0  # programs that want to run, for each core of this machine
_ON_THE_NETWORK = ("input → gateway", "send → displayed")  # the stages that a cable makes shorter
_BUSY = "This machine is busy: close a room, other windows or other programs."
LOW_SPACE_BYTES = 1_000_000_000
CERTIFICATE_DAYS = 7.0  # one that this site made itself is renewed long before


@dataclass(frozen=True)
class HealthFinding:
    """One thing that is known, and with `mend` what to do; empty where all is well."""

    area: str  # services, rooms, delays or machine
    name: str
    found: str
    mend: str = ""


@dataclass(frozen=True)
class RelayCheck:
    """What became of asking a STUN or TURN server: what it gave, or why it gave nothing, in words."""

    ok: bool
    found: str


@dataclass(frozen=True)
class _Part:
    kind: ServiceKind
    name: str
    mend: str
    needed: bool = True


_PARTS = (
    _Part(ServiceKind.SIM, "Rooms", "Open one in the lobby, or start `mart sim`."),
    _Part(
        ServiceKind.GATEWAY,
        "Pictures and hands",
        "Start `mart gateway`; nobody sees or drives anything without.",
    ),
    _Part(ServiceKind.RECORDER, "Recording", "Start `mart recorder`; nothing is saved without."),
    _Part(ServiceKind.REPLICA, "Verification", "Start `mart replica`; episodes stay unverified without."),
    _Part(ServiceKind.EXPERTS, "Scripts", "Start `mart experts`; a seat on script stands still without."),
    _Part(ServiceKind.CATALOGUE, "Episodes page", "Start `mart catalogue`."),
    _Part(ServiceKind.TRAINER, "Training", "", needed=False),
    _Part(ServiceKind.POLICIES, "Policies in seats", "", needed=False),
)


def services(running: Mapping[str, Sequence[str]]) -> Iterator[HealthFinding]:
    """Yield what is known of each part; `running`: kind → ids."""
    for part in _PARTS:
        ids = running.get(part.kind, ())
        if ids:
            yield HealthFinding("services", part.name, ", ".join(ids))
        else:
            yield HealthFinding("services", part.name, "not running", part.mend if part.needed else "")


def rooms(seen: Iterable[Json]) -> Iterator[HealthFinding]:
    """Yield what is known of each room; `seen`: the rooms as the lobby shows them."""
    for room in seen:
        found = f"{room['title']}, {room['real_time_factor']:.2f}× real time"
        mend = ""
        if room["stale"]:
            found = "does not answer"
            mend = "It comes back by itself when its simulation runs again; its log says what happened."
        elif room["stop"] and room["stop"]["by_host"]:
            found = f"paused by {room['stop']['name']}, the host"
            mend = "A host lets it go on, at /host: press Go on twice."
        elif room["stop"]:
            found = f"stopped by {room['stop']['name']}"
            mend = "Anybody lets it go on: press Go on twice, in the lobby or in the room."
        elif room["waiting_for"]:
            late = ", ".join(one["name"] or one["arm"] for one in room["waiting_for"])
            found, mend = (
                f"waits for {late}",
                "Ask them, or set their seat to script or hold once it is free.",
            )
        elif room["slow"]:
            mend = _BUSY
        yield HealthFinding("rooms", room["room"], found, mend)


def cameras(seen: Iterable[Json]) -> Iterator[HealthFinding]:
    """Yield what is known of each real camera; `seen`: as for `rooms`."""
    for room in seen:
        for one in room["cameras"]:
            mend = "Look at its cable, its light and its lens, and whether `mart camera` runs; it comes back by itself."
            yield HealthFinding(
                "rooms",
                f"camera {camera_title(one['camera'])} in {room['room']}",
                one["dark"] or "gives pictures",
                mend if one["dark"] else "",
            )


def delays(newest: Iterable[tuple[str, Event.Latency]], load: float = 0.0) -> Iterator[HealthFinding]:
    """Yield what is known of each seat's delay; `newest`: its last report, with its room.

    `load`: how many programs want to run for each core of this machine. Where it is busy, that comes first: a browser
    that shows pictures late looks like a network.
    """
    for room, latency in newest:
        found = f"{latency.p50_ms:.0f} ms typical, 95 % under {latency.p95_ms:.0f} ms{_drawn_by(latency)}"
        late = latency.p50_ms > LATE_MS or latency.p95_ms > LATE_P95_MS
        mend = _mend_of_delay(latency, load) if late else ""
        yield HealthFinding("delays", f"{latency.arm} in {room}, hand to picture", found, mend)


def _drawn_by(latency: Event.Latency) -> str:
    """Return what a page that draws by itself needs for it, or would need, as an addition to its delay."""
    draw = f"{latency.draw_p50_ms:.0f} ms a draw, 95 % under {latency.draw_p95_ms:.0f} ms"
    if latency.drawn_in_page:
        return f"; drawn in the page, {draw}, {latency.draws_per_s:.0f} a second"
    return f"; video, since the page would need {draw}" if latency.draw_p50_ms else ""


def _mend_of_delay(latency: Event.Latency, load: float) -> str:
    stage = max(latency.stages, key=lambda one: one.p50_ms, default=None)
    worst = f" Most of it: {stage.name.replace('_', ' ')}." if stage else ""
    if load > BUSY_LOAD or (stage is not None and stage.name not in _ON_THE_NETWORK):
        return f"{_BUSY}{worst}"
    return f"Use a cable, or move nearer to the access point.{worst}"


def pictures(missing: Iterable[tuple[str, Event.NoPicture]]) -> Iterator[HealthFinding]:
    """Yield each seat that gets no picture; `missing`: what it said last, with its room."""
    for room, report in missing:
        mend = "Try `mart doctor` on the machine where the gateway runs: it opens what drawing needs."
        yield HealthFinding("rooms", f"{report.arm} in {room}, picture", report.reason, mend)


def machine(free_bytes: int, certificate_days: float | None) -> Iterator[HealthFinding]:
    """Yield what is known of this computer; `certificate_days`: until it ends, None where it cannot be read."""
    full = free_bytes < LOW_SPACE_BYTES
    yield HealthFinding(
        "machine",
        "Disk",
        f"{free_bytes / 1e9:.1f} GB free",
        "Make room before the next episode." if full else "",
    )
    if certificate_days is None:
        yield HealthFinding("machine", "Certificate", "cannot be read", "Look at MART_CERTIFICATE.")
    else:
        soon = certificate_days < CERTIFICATE_DAYS
        mend = "Put a new one at MART_CERTIFICATE; it is taken up within a minute." if soon else ""
        yield HealthFinding("machine", "Certificate", f"good for {certificate_days:.0f} days", mend)


def relays(checks: Mapping[str, RelayCheck]) -> Iterator[HealthFinding]:
    """Yield what is known of each STUN and TURN server; `checks`: by its URL."""
    for url, check in checks.items():
        kind = "Relay (TURN)" if url.startswith("turn") else "Address (STUN)"
        mend = "" if check.ok else "Connections across networks may fail; see MART_ICE_SERVERS."
        yield HealthFinding("machine", kind, check.found if not check.ok else f"{url} {check.found}", mend)
