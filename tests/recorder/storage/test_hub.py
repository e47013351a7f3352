"""Exports on a hub: private, whole, tagged as LeRobot wants it; nobody else's data is touched, and no token is told."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, NotFound, Unavailable
from mart.recorder.export_cli import export
from mart.recorder.storage.hub import HubTarget, push_export
from mart.recorder.storage_cli import push
from mart.sim.world import World
from tests.recorder.storage.hub_server import TOKEN, Hub, running_hub
from tests.trainer import recorded

REPO = "ana/cubes"

# huggingface_hub 2.4 does so itself where it uploads without Xet.
pytestmark = pytest.mark.filterwarnings("ignore:Use 'content=:DeprecationWarning")


@pytest.fixture(scope="module")
def episodes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root, world = tmp_path_factory.mktemp("episodes"), World.build(recorded.TASK)
    recorded.write(root, world, recorded.perform(world, 1, most_ticks=6), with_model=True)
    return root


@pytest.fixture
def hub(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Hub]:
    with running_hub() as hub:
        monkeypatch.setenv("HF_ENDPOINT", hub.endpoint)
        monkeypatch.setenv("HF_TOKEN", TOKEN)
        monkeypatch.setattr(
            "huggingface_hub.constants.HF_HUB_DISABLE_XET", True
        )  # as the variable of that name does
        yield hub


def exported(episodes: Path, out: Path, *arguments: str, file_format: str = "lerobot") -> Path:
    command = [str(episodes), "--format", file_format, "--out", str(out), "--jobs", "1", *arguments]
    export.main(command, standalone_mode=False)
    return out


def contents(folder: Path) -> dict[str, bytes]:
    return {
        one.relative_to(folder).as_posix(): one.read_bytes() for one in folder.rglob("*") if one.is_file()
    }


def test_an_export_goes_with_its_card_private_tagged_and_without_a_word_of_the_token(
    hub: Hub,
    episodes: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.DEBUG)
    out = exported(episodes, tmp_path / "cubes", "--camera", "front:32x32", "--push", REPO)
    repo = hub.repos[REPO]
    assert (repo.private, repo.tags, len(repo.commits)) == (True, ["v3.0"], 1)
    assert repo.files == {**contents(out), ".gitattributes": repo.files[".gitattributes"]}
    said = capsys.readouterr()
    assert f"{hub.endpoint}/datasets/{REPO}" in said.out
    assert TOKEN not in said.out + said.err + caplog.text
    push.main([str(out), f"hf://datasets/{REPO}"], standalone_mode=False)  # again: it is all there
    assert (repo.tags, len(repo.commits)) == (["v3.0"], 1)


def test_an_hdf5_file_goes_with_its_card_as_what_the_data_set_is(
    hub: Hub, episodes: Path, tmp_path: Path
) -> None:
    out = exported(episodes, tmp_path / "cubes.hdf5", "--push", REPO, "--public", file_format="robomimic")
    repo = hub.repos[REPO]
    assert (repo.private, repo.tags) == (False, [])
    assert repo.files["cubes.hdf5"] == out.read_bytes()
    assert repo.files["README.md"] == out.with_suffix(".md").read_bytes()


def test_what_else_is_there_stays_unless_it_is_to_be_replaced(
    hub: Hub, episodes: Path, tmp_path: Path
) -> None:
    out = exported(episodes, tmp_path / "cubes", "--push", REPO)
    repo = hub.repos[REPO]
    repo.files |= {"data/of_ben.parquet": b"his", "meta/info.json": b"{}"}
    before = dict(repo.files)
    with pytest.raises(Conflict, match="data/of_ben"):
        push_export(out, HubTarget(REPO))
    with pytest.raises(Conflict):  # before anything is drawn
        exported(episodes, tmp_path / "again", "--push", REPO)
    assert not (tmp_path / "again").exists()
    assert repo.files == before
    push_export(out, HubTarget(REPO, over=True))
    assert repo.files == {**contents(out), ".gitattributes": before[".gitattributes"]}


def test_one_that_was_interrupted_goes_on(hub: Hub, episodes: Path, tmp_path: Path) -> None:
    out = exported(episodes, tmp_path / "cubes", "--push", REPO)
    repo = hub.repos[REPO]
    del repo.files["README.md"], repo.files["data/chunk-000/file-000.parquet"]
    push_export(out, HubTarget(REPO))
    assert repo.files.keys() - {".gitattributes"} == contents(out).keys()


def test_who_may_not_write_is_told_what_to_do(
    hub: Hub, episodes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HF_TOKEN", "hf_another")
    with pytest.raises(Forbidden, match="HF_TOKEN") as told:
        exported(episodes, tmp_path / "cubes", "--push", REPO)
    assert "hf_another" not in str(told.value)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("repo", ["cubes", "ana/cubes/again", "ana/..", "ana/" + "x" * 200])
def test_names_that_no_data_set_has_are_refused(hub: Hub, episodes: Path, tmp_path: Path, repo: str) -> None:
    with pytest.raises(InvalidInput, match="OWNER/NAME"):
        exported(episodes, tmp_path / "cubes", "--push", repo)


def test_a_hub_that_refuses_and_what_is_no_export_are_told_apart(hub: Hub, tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        push_export(tmp_path / "nothing", HubTarget(REPO))
    (tmp_path / "cubes").mkdir()
    (tmp_path / "cubes/README.md").write_text("# It")
    hub.excuse = "It is being repaired."
    with pytest.raises(Unavailable, match="repaired"):
        push_export(tmp_path / "cubes", HubTarget(REPO))
