"""Print what a collection brings, as it comes."""

from __future__ import annotations

import json
import logging
import sys
from collections.abc import Iterator

import click

from mart.platform.collect.collection import CollectionSpec
from mart.platform.collect.saved_episodes import CollectedEpisode
from mart.platform.collect.summary import CollectionSummary
from mart.protocol import clock
from mart.runtime.progress import counted, progress


def print_collected(spec: CollectionSpec, episodes: Iterator[CollectedEpisode], as_json: bool) -> None:
    """Print each episode as it is saved, then the summary: for people on standard error, with --json as the last line.

    An episode is a line of JSON, and on a terminal without --json a line for people, with a bar below.
    """
    logging.getLogger("httpx").setLevel(logging.WARNING)
    summary = CollectionSummary(clock.monotonic_s())
    for_people = sys.stdout.isatty() and not as_json
    with progress("Episodes", spec.episodes, as_json=as_json) as shown:
        for episode in counted(episodes, shown):
            summary.add(episode)
            path = str(spec.out / episode.path)
            shown.say(
                episode.in_words(path) if for_people else json.dumps({**episode.as_json(), "path": path})
            )
    told = summary.as_json(clock.monotonic_s())
    if as_json:
        click.echo(json.dumps(told))
    else:
        click.echo(f"{summary.in_words(told)} They are in {spec.out / 'episodes'}.", err=True)
