"""The catalogue of ten thousand episodes: how long each request takes, by the handlers and over the bus (`bus_…`), from
a catalogue that is a process of its own.

Each file is a real, finished episode file of metadata alone, so that what is measured is the catalogue, not a disk. The
floor beside it is the least that any answer needs: every name and time of the files, and every row of a bare table.

    python benchmarks/catalogue.py [EPISODES]
"""

from __future__ import annotations

import contextlib
import os
import resource
import sqlite3
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from report import Bar, report
from support.bus_processes import await_alive, child

from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec, keys
from mart.protocol.messages import CatalogueReply, CatalogueRequest, raise_error
from mart.protocol.recording import EpisodeRecord
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.episode_catalogue import FILE_NAME, list_folder
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.recorder.files import write_episode

EPISODES = 10_000
ROOMS = 10
A_DAY = 500
REPEATS = 30
FEW = 5
LONGEST_S = 0.2
NAME, TIMEOUT_S = "bench", 60.0
Ask = Callable[[CatalogueRequest], CatalogueReply]
FIRST_TIME_S = 60.0


def make_episodes(root: Path, count: int, template: Path) -> None:
    """Write `count` files that differ in room, number, time and seed, so many a day."""
    metadata = EpisodeFile.open(template).metadata
    started_ns = int(metadata[EpisodeRecord.NAME]["started_ns"])
    for number in range(count):
        day = root / f"2026-{1 + number // A_DAY // 28:02}-{1 + number // A_DAY % 28:02}"
        day.mkdir(exist_ok=True)
        room = f"room-{number % ROOMS}"
        own = {
            "room": room,
            "number": str(number),
            "started_ns": str(started_ns + number * 10**10),
            "seed": str(number),
        }
        path = day / f"{room}-{number:05}.mcap"
        file = EpisodeWriter(path)
        for name, known in metadata.items():
            file.add_record(name, {**known, **own} if name == EpisodeRecord.NAME else known)
        file.finish()
        file.move_to(path)


def timed(call: Callable[[int], object], repeats: int = REPEATS) -> list[float]:
    """Return how long each call took, in seconds."""
    found = []
    for number in range(repeats):
        began_s = time.perf_counter()
        call(number)
        found.append(time.perf_counter() - began_s)
    return found


def requests(root: Path, ask: Ask, way: str) -> dict[str, Callable[[int], object]]:
    """Return each kind of request by name; every call is one that changes, or follows a change of, something.

    way: of asking, a part of the names of data sets.
    """
    rows = [row.path for row in list_folder(root)]

    def listed(**wanted: Any) -> object:
        return ask(CatalogueRequest(list=CatalogueRequest.List(**wanted))).listing.matching

    def label(number: int) -> object:
        said = CatalogueRequest.Label(path=rows[number], note=f"note {number}")
        return ask(CatalogueRequest(label=said))

    def curate(dataset: str, **which: Any) -> int:
        wanted = CatalogueRequest.Curate(dataset=dataset, **which)
        return ask(CatalogueRequest(curate=wanted)).curated.act_ns

    acts: list[int] = []

    def curate_all(number: int) -> object:
        acts.append(curate(f"{way}all-{number}", all=CatalogueRequest.List()))
        return None

    def undo(number: int) -> object:
        undone = CatalogueRequest.Undo(dataset=f"{way}all-{number}", act_ns=acts[number])
        return ask(CatalogueRequest(undo=undone))

    return {
        "list_page": lambda _: listed(),
        "list_filtered": lambda number: listed(room=f"room-{number % ROOMS}", outcome="success"),
        "label": label,
        "list_after_label": lambda number: (label(number), listed()),
        "curate_200": lambda number: curate(
            f"{way}set-{number}", paths=[rows[(number * 200 + i) % len(rows)] for i in range(200)]
        ),
        "list_of_data_set": lambda number: listed(dataset=f"{way}set-{number}"),
        "curate_all": curate_all,
        "undo_all": undo,
    }


def measured(root: Path, ask: Ask, way: str) -> tuple[dict[str, float], list[Bar]]:
    """Make each request again and again; returns the figures, and the bars."""
    metrics, bars = {}, []
    (metrics[f"{way}first_list_s"],) = timed(lambda _: ask(CatalogueRequest(list=CatalogueRequest.List())), 1)
    for name, call in requests(root, ask, way).items():
        taken = timed(call, FEW if name in ("curate_all", "undo_all") else REPEATS)
        for percent in (50, 99):
            metrics[f"{way}{name}_p{percent}_ms"] = 1e3 * float(np.percentile(taken, percent))
        bars.append(Bar.at_most(f"{way}{name}_p50_s", float(np.median(taken)), LONGEST_S))
    return metrics, bars


@contextlib.contextmanager
def catalogue_process(folder: Path) -> Iterator[Ask]:
    """Run a router and a catalogue of `folder`; gives what asks it."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with contextlib.ExitStack() as opened:
        for command in (("router", "--listen", endpoint), ("catalogue", "--name", NAME)):
            environment = {"MART_ROUTER": endpoint, "MART_DATA_DIR": str(folder)}
            opened.enter_context(child("mart", *command, **environment))
        bus = opened.enter_context(ZenohBus.connect(endpoint))
        await_alive(bus, keys.alive(ServiceKind.CATALOGUE, NAME))

        def ask(request: CatalogueRequest) -> CatalogueReply:
            answer = bus.query(keys.catalogue(NAME), codec.encode(request), TIMEOUT_S)
            reply = codec.decode(CatalogueReply, answer)
            raise_error(reply.error)
            return reply

        yield ask


def floor(root: Path) -> dict[str, float]:
    """Time the least that an answer stands on: names and times of the files, and a scan of the bare table."""

    def walk(_: int) -> int:
        return sum(
            os.stat(os.path.join(place, name)).st_size for place, _, names in os.walk(root) for name in names
        )

    with contextlib.closing(sqlite3.connect(root / FILE_NAME)) as database:
        scan = timed(lambda _: database.execute("SELECT path, checksum FROM episode").fetchall())
    return {"walk_p50_ms": 1e3 * float(np.median(timed(walk))), "scan_p50_ms": 1e3 * float(np.median(scan))}


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else EPISODES
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "episodes"
        template = write_episode(Path(folder) / "template", ticks=5).path
        root.mkdir()
        make_episodes(root, count, template)
        (rebuild_s,) = timed(lambda _: list_folder(root), 1)
        before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        metrics: dict[str, float] = {"episodes": count, "rebuild_s": rebuild_s}
        with contextlib.closing(CatalogueHandlers(root)) as asked:
            figures, bars = measured(root, asked.answer, "")
        metrics |= figures
        metrics["peak_memory_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        metrics["peak_memory_before_mb"] = before_kb / 1024
        with catalogue_process(Path(folder)) as ask:
            figures, more = measured(root, ask, "bus_")
        metrics |= figures
        bars += more
        bars.append(Bar.at_most("rebuild_s", rebuild_s, FIRST_TIME_S))
        report("catalogue", metrics, floor(root), bars)


if __name__ == "__main__":
    main()
