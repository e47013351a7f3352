"""Longer episodes take little more memory, so that an hour of three arms with video stays below 512 MB."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.system]
SHORT_MIN, LONG_MIN = 1, 4
# An hour of each was measured: 76, 79, 58, 153 and 453 MB, of which a process without an episode has 50.
MOST_MB_A_MINUTE = {
    "recorded": 1.5,
    "shown": 1.5,
    "verified": 1.5,
    "learned from": 3.5,
    "read as arrays": 8.4,
}
WORK = """
import json, resource, sys
from contextlib import closing
from pathlib import Path

from mart.episodes.reader import EpisodeFile
from mart.protocol.messages import CatalogueRequest
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.verify.resimulation import verify
from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import load_dataset
from tests.recorder.long_episode import replica, write_long_episode

root, found = Path(sys.argv[1]), {}

def note(what):
    found[what] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

path = write_long_episode(root, float(sys.argv[2])).path
note("recorded")
file = EpisodeFile.open(path)
assert verify(file, file.room, replica).verdict == "verified"
note("verified")
with closing(CatalogueHandlers(root)) as asked:
    (row,) = asked.answer(CatalogueRequest(list=CatalogueRequest.List())).listing.episodes
    asked.answer(CatalogueRequest(show=CatalogueRequest.Show(path=row.path)))
note("shown")
load_dataset([path], Selection(), root)
note("learned from")
file.arrays()
note("read as arrays")
print(json.dumps(found))
"""


def peaks_mb(root: Path, minutes: int) -> dict[str, float]:
    command = [sys.executable, "-c", WORK, str(root), str(minutes)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    peaks: dict[str, float] = json.loads(done.stdout)
    return peaks


def test_memory_grows_little_with_an_episodes_length(tmp_path: Path) -> None:
    short, long = (peaks_mb(tmp_path / str(minutes), minutes) for minutes in (SHORT_MIN, LONG_MIN))
    grown = {what: (long[what] - short[what]) / (LONG_MIN - SHORT_MIN) for what in short}
    assert {what: mb for what, mb in grown.items() if mb > MOST_MB_A_MINUTE[what]} == {}, (short, long)
