"""Read, write, label, filter and put together MART's episode files. No service has to run.

Open one, and it is arrays:

    from mart.episodes import open_episode

    episode = open_episode("data/episodes/2026-11-22/room-1-0001-two_arm_multi_cube_lifting.mcap")
    data = episode.arrays()
    data.observations["arm0/gripper"]  # float64[T + 1, …]: before each action, and after the last
    data.actions  # float64[T, arms, 7]
    episode.arrays(control_hz=20.0)  # the same motion in ticks of 20 Hz, from a recording of any rate above

List a folder with what people have said about its episodes, and choose:

    from mart.episodes import EpisodeFilter, list_episodes

    wanted = EpisodeFilter(outcomes=("success",), verdicts=("verified",))
    for episode in list_episodes("data/episodes", wanted):
        print(episode.path, episode.ticks, episode.operators)

Say something about one afterwards; the file itself never changes:

    from mart.episodes import LabelKind, labels

    labels.say(episode.file_path, LabelKind.NOTE, "the cube slipped", at_ns=time.time_ns())
"""

from mart.episodes import datasets, labels
from mart.episodes.arrays import EpisodeData, arrays_for_task, arrays_from_states
from mart.episodes.compatibility import require_alike
from mart.episodes.datasets import NamedDataSet
from mart.episodes.filter import COUNTED, EpisodeFilter
from mart.episodes.folder import episode_files, find_episodes, list_episodes
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.labels import EpisodeLabels, Label, LabelKind
from mart.episodes.mcap_entries import McapEntry
from mart.episodes.reader import EpisodeFile, RecordedMessage, open_episode
from mart.episodes.resampling import at_control_hz
from mart.episodes.writer import EpisodeWriter

__all__ = [
    "COUNTED",
    "EpisodeData",
    "EpisodeFile",
    "EpisodeFilter",
    "EpisodeLabels",
    "EpisodeWriter",
    "Label",
    "LabelKind",
    "LabelledEpisode",
    "McapEntry",
    "NamedDataSet",
    "RecordedMessage",
    "arrays_for_task",
    "arrays_from_states",
    "at_control_hz",
    "datasets",
    "episode_files",
    "find_episodes",
    "labels",
    "list_episodes",
    "open_episode",
    "require_alike",
]
