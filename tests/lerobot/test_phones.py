"""Emulated phones lift cubes with a robot of LeRobot's kind and a simulated arm, through the whole platform."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path

from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.collect.live_session import LiveSession
from mart.platform.collect.saved_episodes import SavedEpisodes
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import running_platform
from mart.protocol.messages import EpisodeRequest
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.runtime.ports import free_port
from tests.lerobot.test_driver import ROOM, led_by_lerobot
from tests.support.message_collector import NothingCame
from tests.system.room_client import RoomClient

_LOOK_S = 0.5


@contextlib.contextmanager
def somebody_goes_on(client: RoomClient) -> Iterator[list[str]]:
    """A person presses Go on whenever the room is stopped and its arm is well again; yields what stopped it.

    A busy machine holds a process up for longer than an arm may be silent. Such a stop stays until a person lets it go,
    as every stop does; phones then press their clutches anew.
    """
    stopped_by: list[str] = []
    leaves = threading.Event()

    def watch() -> None:
        while not leaves.is_set():
            with contextlib.suppress(NothingCame):
                status = client.statuses.wait_next(_LOOK_S)
                if status.HasField("stop") and not any(arm.fault for arm in status.driven_arms):
                    stopped_by.append(status.stop.fault)
                    client.episode(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva")))

    person = threading.Thread(target=watch)
    person.start()
    try:
        yield stopped_by
    finally:
        leaves.set()
        person.join()


def test_emulated_phones_lift_the_cubes_and_the_episode_is_saved(tmp_path: Path) -> None:
    options = PlatformOptions(
        tmp_path / "data",
        router=f"tcp/127.0.0.1:{free_port()}",
        port=free_port(),
        control_hz=20.0,
        seed=1,
        drivers=("arm0",),
    )
    with (
        running_platform(options) as platform,
        led_by_lerobot(tmp_path / "lerobot", options.router, tmp_path / "hangs") as client,
        somebody_goes_on(client) as stopped_by,
        EmulatedUsers(platform, skill="expert", seed=0).seated(["arm0", "arm1"]) as people,
        contextlib.closing(LiveSession(platform.bus, ROOM, SavedEpisodes(options.data_dir).find)) as session,
    ):
        episode = session.run_episode(people)
    print(f"Stopped {len(stopped_by)} times: {stopped_by}")
    assert episode.outcome is EpisodeOutcome.SUCCESS
    assert episode.verdict is Verdict.REAL
