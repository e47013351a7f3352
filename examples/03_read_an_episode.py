"""Read an episode into numpy arrays: what was seen and done, who drove, how it ended. No service needs to run.

    python examples/03_read_an_episode.py [EPISODE.mcap] [--data FOLDER]

Without a file, the newest episode of the folder that can be read is taken.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mart.episodes import EpisodeFilter, LabelledEpisode, list_episodes


def main() -> None:
    parser = argparse.ArgumentParser(description="Read an episode.")
    parser.add_argument("episode", nargs="?", type=Path, help="An episode file.")
    parser.add_argument("--data", type=Path, default=Path("data/episodes"), help="A folder of episodes.")
    given = parser.parse_args()
    show(given.episode or newest(given.data))


def newest(folder: Path) -> Path:
    """Return the newest file of a folder that is neither dropped nor damaged."""
    found: list[LabelledEpisode] = list_episodes(folder, EpisodeFilter())
    if not found:
        raise SystemExit(f"There are no episodes in {folder}; record one with `mart collect`.")
    return found[-1].file_path


def show(path: Path) -> None:
    """Print what a file says, what people have said since, and the shapes of its arrays."""
    (episode,) = list_episodes(path)
    file = episode.open()
    print(f"{path.name}: {episode.outcome} ({episode.reason}), {episode.verdict}")
    for arm, who in episode.operators.items():
        print(f"{arm} was driven by {who}")

    data = file.arrays()
    for name, values in data.observations.items():
        print(f"{name}: {values.shape}")
    print(f"actions: {data.actions.shape}, of {', '.join(data.arms)}")
    for name, done in data.subtasks.items():
        reached = f"first done after {done.argmax()} ticks" if done.any() else "never done"
        print(f"{name}: {reached}")
    print(f"{len(data)} ticks, {data.sim_time_s[-1] - data.sim_time_s[0]:.1f} s of simulated time")

    topics = sorted({message.topic for message in file.messages()})
    print(f"recorded: {', '.join(topics)}")


if __name__ == "__main__":
    main()
