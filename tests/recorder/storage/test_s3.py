"""The same with a store that speaks S3: a real server on a port of this machine."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import boto3
import pytest
from moto.server import ThreadedMotoServer

from mart.episodes import labels
from mart.episodes.labels import LabelKind
from mart.protocol.errors import Conflict, MartError
from mart.recorder.storage.store import Store
from mart.recorder.storage.transfer import Transferred, pull, push, to_pull, to_push
from tests.recorder.conftest import Mart
from tests.recorder.files import write_episode

pytestmark = pytest.mark.system
BUCKET, URL = "lab", "s3://lab/episodes"


@pytest.fixture
def endpoint(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "testing-only")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    _, port = server.get_host_and_port()
    url = f"http://127.0.0.1:{port}"
    boto3.client("s3", endpoint_url=url).create_bucket(Bucket=BUCKET)
    yield url
    server.stop()


def test_episodes_and_labels_go_to_s3_and_back(mart: Mart, path: Path, endpoint: str, tmp_path: Path) -> None:
    labels.say(path, LabelKind.NOTE, "cube slipped", at_ns=5)
    at = ("--endpoint-url", endpoint)
    (name,) = mart.json("episodes", "push", URL, *at)["files"]
    assert mart.json("episodes", "push", URL, *at)["there"] == 1
    out = tmp_path / "elsewhere"
    assert mart.json("episodes", "pull", URL, "--out", out, *at)["labels"] == 1
    assert (out / name).read_bytes() == path.read_bytes()

    objects = boto3.client("s3", endpoint_url=endpoint)
    objects.put_object(Bucket=BUCKET, Key=f"episodes/{name}", Body=path.read_bytes()[:-50])
    said = mart("episodes", "pull", URL, "--out", tmp_path / "another", *at, code=1)
    assert "not whole" in said
    assert "differs" in mart("episodes", "push", URL, *at, code=1)
    assert "testing-only" not in mart("episodes", "push", "s3://no-such-bucket/x", *at, code=1)


def test_of_two_who_push_at_once_one_hears_of_the_other(endpoint: str, tmp_path: Path) -> None:
    roots = [tmp_path / "one", tmp_path / "two"]
    for ticks, root in zip((10, 12), roots, strict=True):
        write_episode(root, ticks=ticks)
    ready, refused = threading.Barrier(2), list[MartError]()

    def push_at_once(root: Path) -> None:
        store, files = Store.open("s3://lab/at-once", endpoint), to_push([root])
        ready.wait()
        try:
            push(files, store, lambda: None)
        except MartError as error:
            refused.append(error)

    threads = [threading.Thread(target=push_at_once, args=(root,)) for root in roots]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [type(error) for error in refused] == [Conflict], refused


def test_two_who_pull_at_once_into_one_folder_get_each_file_and_each_word_once(
    endpoint: str, tmp_path: Path
) -> None:
    source, out = tmp_path / "source", tmp_path / "out"
    episodes = [write_episode(source, ticks=10, number=number + 1).path for number in range(4)]
    for number, episode in enumerate(episodes):
        labels.say(episode, LabelKind.NOTE, f"note {number}", at_ns=100 - number)
    push(to_push([source]), Store.open("s3://lab/pulled", endpoint), lambda: None)
    ready, done = threading.Barrier(2), list[Transferred]()

    def pull_at_once() -> None:
        store = Store.open("s3://lab/pulled", endpoint)
        sizes = to_pull(store)
        ready.wait()
        done.append(pull(sizes, store, out, lambda: None))

    threads = [threading.Thread(target=pull_at_once) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sum(len(one.files) for one in done) == len(episodes)
    assert sum(one.there for one in done) == len(episodes)
    assert sum(one.labels for one in done) == len(episodes)
    assert sorted(labels.read(out), key=str) == sorted(labels.read(source), key=str)
    for episode in episodes:
        assert (out / episode.relative_to(source)).read_bytes() == episode.read_bytes()
    assert not [one for one in out.rglob(".*") if one.is_file()]
