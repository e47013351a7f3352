"""Ten rooms of three arms with video, recorded by one recorder over the real bus, for a minute.

Router and recorder are processes of their own; this one plays the rooms, without physics: 2,600 messages a second. What
was lost is told by sequence numbers: each state, command and picture that was sent is looked for in the files. The lag
is how old the oldest state was that the recorder had not yet said to have. Beside it, the messages of a minute of one
room are written with `mcap`, as the recorder does, and by foxglove-sdk in an environment of its own.

    python benchmarks/recorder.py [SECONDS]
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from report import Bar, report, spread
from support.bus_processes import await_alive, child
from support.peers import running as peer
from support.played_rooms import PlayedRoom, play

from mart.episodes.mcap_entries import McapEntry
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec, keys
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Command, Event, State
from mart.protocol.recording import STATE, command_topic, video_topic
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.recorder.long_episode import ARMS, write_long_episode

SECONDS, ROOMS, REPEATS = 60.0, 10, 5
MOST_LAG_S, MOST_GROWTH_MB = 1.0, 32.0
_SAVED_WITHIN_S = 180.0
_TICKS_PER_S = os.sysconf("SC_CLK_TCK")
_PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1e6


class Watch:
    """Takes, each second, what a process has used and holds."""

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self.cpu_s, self.memory_mb, self.at_s = list[float](), list[float](), list[float]()

    def look(self) -> None:
        fields = Path(f"/proc/{self._pid}/stat").read_text().rpartition(")")[2].split()
        self.at_s.append(time.monotonic())
        self.cpu_s.append((int(fields[11]) + int(fields[12])) / _TICKS_PER_S)
        self.memory_mb.append(int(fields[21]) * _PAGE_MB)

    def cores(self, begin: int, end: int) -> float:
        return (self.cpu_s[end] - self.cpu_s[begin]) / (self.at_s[end] - self.at_s[begin])


def record(seconds: float) -> dict[str, float]:
    """Record the rooms; returns the figures."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with contextlib.ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        opened.enter_context(child("mart", "router", "--listen", endpoint))
        environment = {"MART_ROUTER": endpoint, "MART_DATA_DIR": str(folder)}
        recorder = opened.enter_context(child("mart", "recorder", "--name", "recorder-1", **environment))
        buses = [opened.enter_context(ZenohBus.connect(endpoint)) for _ in range(2)]
        await_alive(buses[0], keys.alive(ServiceKind.RECORDER, "recorder-1"))
        saved = Saved(buses[0])
        rooms = [PlayedRoom(f"bench-{number}", *buses) for number in range(ROOMS)]
        time.sleep(3.0)  # until the recorder knows that the rooms are alive
        watch = Watch(recorder.pid)
        late_s = play(rooms, seconds, watch.look)
        saved.wait(ROOMS)
        watch.look()
        lost = dict.fromkeys(rooms[0].sent, 0)
        for room in rooms:
            for kind, count in lost_of(room, folder).items():
                lost[kind] += count
        third = (len(watch.at_s) - 1) // 3
        lags_s = [lag_s for room in rooms for lag_s in room.lag_s]
        return {
            "seconds": seconds,
            "messages_a_second": sum(room.messages for room in rooms) / seconds,
            **{f"lost_{kind}": count for kind, count in lost.items()},
            "cores_first_third": watch.cores(0, third),
            "cores_last_third": watch.cores(2 * third, 3 * third),
            "memory_after_a_third_mb": watch.memory_mb[third],
            "memory_at_the_end_mb": watch.memory_mb[-2],
            "memory_when_saved_mb": watch.memory_mb[-1],
            **{f"lag_p{share}_ms": 1e3 * float(np.percentile(lags_s, share)) for share in (50, 99)},
            "worst_stall_ms": 1e3 * max(lags_s),
            "player_late_at_most_ms": 1e3 * late_s,
        }


class Saved:
    """Hears which rooms have their file."""

    def __init__(self, bus: ZenohBus) -> None:
        self._rooms, self._changed = set[str](), threading.Condition()
        bus.subscribe(keys.EVERY_EVENT, lambda sample: self._hear(sample.payload))

    def wait(self, count: int) -> None:
        with self._changed:
            if not self._changed.wait_for(lambda: len(self._rooms) >= count, _SAVED_WITHIN_S):
                raise SystemExit(f"Only {len(self._rooms)} of {count} rooms have a file.")

    def _hear(self, payload: bytes) -> None:
        with contextlib.suppress(InvalidInput), self._changed:
            event = codec.decode(Event, payload)
            if event.HasField("episode_saved"):
                self._rooms.add(event.room)
                self._changed.notify_all()


def lost_of(room: PlayedRoom, folder: Path) -> dict[str, int]:
    """Return of each kind how many messages that were sent are in no file."""
    found = set[tuple[str, int]]()
    kinds = {STATE: "states"}
    kinds |= {command_topic(arm): "commands" for arm in ARMS} | {video_topic(arm): "pictures" for arm in ARMS}
    for path in folder.rglob(f"{room.name}-*.mcap"):
        for message in EpisodeFile.open(path).messages(*kinds):
            number = message.sent_ns if kinds[message.topic] == "pictures" else message.sequence
            found.add((message.topic, number))
    return {kind: len(sent - found) for kind, sent in room.sent.items()}


def write_beside(seconds: float) -> tuple[dict[str, float], dict[str, float]]:
    """Write the messages of one room by turns with `mcap` and with foxglove-sdk; returns ours, and the peer's."""
    schemas = {
        "mart.v1.State": State,
        "mart.v1.Command": Command,
        "foxglove.CompressedVideo": CompressedVideo,
    }
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = write_long_episode(folder / "source", seconds / 60).path
        entries = [
            McapEntry(one.topic, schema, one.payload, one.arrived_ns, one.sent_ns, one.sequence)
            for one in EpisodeFile.open(source).messages()
            for schema in [schemas.get(_schema_of(one.topic), Event)]
        ]
        ours, theirs, ratios = list[float](), list[float](), list[float]()
        with peer("foxglove", "write.py", source, folder / "theirs.mcap") as other:
            for number in range(REPEATS):
                began_s = time.process_time()
                file = EpisodeWriter(folder / f"{number}.mcap.part")
                for entry in entries:
                    file.add(entry)
                file.finish()
                ours.append(1e6 * (time.process_time() - began_s) / len(entries))
                file.discard()
                other.tell("again")
                answer = other.answer()
                theirs.append(1e6 * answer["cpu_s"] / answer["messages"])
                ratios.append(ours[-1] / theirs[-1])
    return spread("write_us_a_message", ours) | spread("write_over_foxglove", ratios), spread(
        "foxglove_write_us_a_message", theirs
    )


def _schema_of(topic: str) -> str:
    if topic == STATE:
        return "mart.v1.State"
    return "mart.v1.Command" if "command" in topic else "foxglove.CompressedVideo"


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    metrics = record(seconds)
    written, theirs = write_beside(seconds)
    grown_mb = metrics["memory_at_the_end_mb"] - metrics["memory_after_a_third_mb"]
    bars = [
        Bar.at_most("lost states and commands", metrics["lost_states"] + metrics["lost_commands"], 0),
        Bar.at_most("lost pictures", metrics["lost_pictures"], 0),
        Bar.at_most("memory grown after the first third, MB", grown_mb, MOST_GROWTH_MB),
        Bar.at_most("worst stall, s", metrics["worst_stall_ms"] / 1e3, MOST_LAG_S),
    ]
    report("recorder", metrics | written, theirs, bars)


if __name__ == "__main__":
    main()
