"""Offer `mart episodes push` and `mart episodes pull`: episodes, labels and exports, to and from a store.

Heavy modules are imported inside: `mart --help` loads this file.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.protocol.errors import InvalidInput
from mart.recorder.hub_options import hub_options
from mart.recorder.settings import RecorderSettings
from mart.runtime.cli import json_option, print_result
from mart.runtime.progress import progress

if TYPE_CHECKING:
    from mart.recorder.storage.transfer import Transferred

_endpoint_url = click.option(
    "--endpoint-url", default="", help="Of an S3-compatible store that is not Amazon's, such as MinIO."
)


@click.command()
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path))
@click.argument("url")
@_endpoint_url
@hub_options
@json_option
def push(
    *, paths: tuple[Path, ...], url: str, endpoint_url: str, public: bool, over: bool, as_json: bool
) -> None:
    """Bring finished episodes with their labels, or folders of exports, to a store: s3://bucket/folder, file:///folder.

    Without PATHS, all that were recorded here. What is there already is skipped, and nothing is overwritten. Who you
    are there comes from the environment. hf://datasets/OWNER/NAME takes one export, as a data set of a hub.
    """
    from mart.recorder.storage.hub import HubTarget, push_export

    target = HubTarget.of_url(url, public=public, over=over)
    if target is not None:
        if len(paths) != 1:
            raise InvalidInput(f"{len(paths)} paths were given; a data set on a hub takes one export.")
        address = push_export(paths[0], target)
        print_result({"url": address, "path": str(paths[0])}, f"{paths[0]} is at {address}.", as_json)
        return
    from mart.recorder.storage.store import Store
    from mart.recorder.storage.transfer import push as push_files
    from mart.recorder.storage.transfer import to_push

    files = to_push(list(paths or (RecorderSettings().episodes_dir,)))
    store = Store.open(url, endpoint_url)
    with progress("Pushed", len(files), as_json=as_json) as shown:
        done = push_files(files, store, shown.advance)
    text = f"{url}: {_counted(done)}."
    print_result({"url": url, **asdict(done)}, text, as_json)


@click.command()
@click.argument("url")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="The folder to pull into.")
@_endpoint_url
@json_option
def pull(url: str, out: Path, endpoint_url: str, as_json: bool) -> None:
    """Fetch episodes with their labels, and exports, from a store; each file is checked before it gets its name.

    What is there already is skipped, and nothing is overwritten. Labels are put together: none is lost.
    """
    from mart.recorder.storage.store import Store
    from mart.recorder.storage.transfer import pull as pull_files
    from mart.recorder.storage.transfer import to_pull

    store = Store.open(url, endpoint_url)
    sizes = to_pull(store)
    with progress("Pulled", len(sizes), as_json=as_json) as shown:
        done = pull_files(sizes, store, out, shown.advance)
    text = f"{out}: {_counted(done)}."
    print_result({"out": str(out), **asdict(done)}, text, as_json)


def _counted(done: Transferred) -> str:
    size = f"{done.bytes / 1e6:.1f} MB"
    return f"{len(done.files)} new files ({size}), {done.there} were there, {done.labels} new labels"
