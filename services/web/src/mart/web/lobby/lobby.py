"""Everything that the lobby knows of the platform, as the pages see it. Pure; times are monotonic seconds."""

from __future__ import annotations

import json
from collections.abc import Callable

from mart.protocol import keys
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Event, RoomStatus
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.awaited_saves import AwaitedSaves
from mart.web.lobby.last_episodes import LastEpisodes
from mart.web.lobby.listeners import LobbyListeners
from mart.web.lobby.live_services import LiveServices, service_of
from mart.web.lobby.passed_courses import KeepPass, PassedCourses
from mart.web.lobby.room_json import Json, event_json, status_json
from mart.web.lobby.room_table import RoomTable
from mart.web.lobby.seat_reports import SeatReports
from mart.web.lobby.thumbnails import Thumbnails

_NOBODY = ""


def _forget_pass(_is_them: Callable[[str], bool], _seconds: float, _tries: int) -> None:
    """Keep nothing of who passes the practice course."""


class Lobby:
    """What the bus tells, put where it belongs; whoever listens is told of each change."""

    def __init__(self, keep_pass: KeepPass = _forget_pass) -> None:
        """Begin with nothing heard. keep_pass: is told who passes the practice course."""
        self.passed_courses = PassedCourses(keep_pass)
        self.services = LiveServices()
        self.rooms = RoomTable()
        self.thumbnails = Thumbnails()
        self.latencies = SeatReports[Event.Latency]()
        self.missing_pictures = SeatReports[Event.NoPicture]()
        self.awaited_saves = AwaitedSaves()
        self.last_episodes = LastEpisodes()
        self.listeners = LobbyListeners()

    def see_status(self, status: RoomStatus, now_s: float) -> None:
        """Take in a room's status; raises InvalidInput where it holds words that no page could be told."""
        _in_words(status)
        if self.rooms.see(status, now_s):
            self.awaited_saves.see_status(status, now_s)
            self.last_episodes.see_status(status, now_s)
            self.listeners.tell_change()
            self.passed_courses.see_status(status)

    def see_event(self, event: Event, now_s: float, wall_ns: int) -> None:
        """Take in an event heard at `wall_ns` (Unix nanoseconds); raises InvalidInput as `see_status` does."""
        try:
            told = event_json(event)
            json.dumps(told, allow_nan=False)
        except Exception as error:
            raise InvalidInput(f"An event was given that cannot be told: {error}.") from error
        match event.WhichOneof("what"):
            case "latency":
                self.latencies.see(event.room, event.latency.arm, event.latency, now_s)
            case "no_picture":
                self.missing_pictures.see(event.room, event.no_picture.arm, event.no_picture, now_s)
            case "episode_saved":
                self.awaited_saves.see_saved(event.room, event.episode_saved.number)
                seats = self.rooms.seats(event.room)
                self.last_episodes.see_saved(event.room, event.episode_saved, seats, now_s)
        if told is not None:
            self.listeners.tell_event(told, wall_ns)

    def see_silence(self, now_s: float) -> None:
        """Take in that time has passed: a room of which nothing was heard meanwhile is shown as such."""
        if self.rooms.have_fallen_silent(now_s):
            self.listeners.tell_change()

    def see_label(self, path: str, outcome: str) -> None:
        """Take in that somebody has said how the episode at `path`, below the folder of episodes, ended."""
        self.last_episodes.see_label(path, outcome)
        self.listeners.tell_change()

    def see_alive(self, key: str, alive: bool) -> None:
        """Take in that the service of the liveliness key `key` came or went."""
        self.services.tell(key, alive)
        kind, service = service_of(key)
        if kind == ServiceKind.SIM:
            self.rooms.set_alive(service, alive)
        self.listeners.tell_change()

    def see_every_alive(self, alive_keys: list[str]) -> None:
        """Take in the list of all liveliness keys that exist, for those whose coming or going was never told."""
        for key, alive in self.services.compare(alive_keys).items():
            self.see_alive(key, alive)

    def see_thumbnail(self, key: str, jpeg: bytes, now_s: float) -> None:
        """Take in what came under the view's key `key`; raises InvalidInput where it is no small JPEG."""
        self.thumbnails.see(keys.room_of(key), keys.camera_of(key), jpeg, now_s)

    def rooms_json(self, holder_id: str, now_s: float) -> list[Json]:
        """Return the rooms as the user with `holder_id` sees them, by name."""
        return [self.room_json(room, holder_id, now_s) for room in self.rooms.names(now_s)]

    def room_json(self, room: str, holder_id: str, now_s: float) -> Json:
        """Return one room as the user with `holder_id` sees it; raises NotFound where there is none."""
        status = self.rooms.status(room, now_s)
        return {
            **status_json(status, holder_id),
            "stale": self.rooms.is_stale(room, now_s),
            "slow": self.rooms.is_slow(room, now_s),
            "still": self.thumbnails.number(room, now_s),
            "stills": self.thumbnails.numbers(room, now_s),
            "last_episode": self.last_episodes.json(room, now_s),
        }


def _in_words(status: RoomStatus) -> None:
    try:
        json.dumps(status_json(status, _NOBODY), allow_nan=False)
    except Exception as error:
        raise InvalidInput(f"A status of {status.room} was given that cannot be shown: {error}.") from error
