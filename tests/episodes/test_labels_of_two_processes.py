"""Two processes say things of one folder at once: nothing is lost or torn, and each act has a stamp of its own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.labels import Label, LabelKind

pytestmark = pytest.mark.system
COUNT = 60
SAY = """
import sys
from pathlib import Path
from mart.episodes import labels
from mart.episodes.labels import Label, LabelKind
root, name, count = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
print("ready", flush=True)
sys.stdin.readline()
stamps = [
    labels.append(root, [Label(path, LabelKind.NOTE, f"{name} {number}", 1000) for path in "ab"])
    for number in range(count)
]
print(*stamps)
"""


def test_two_processes_that_say_things_at_once_lose_nothing(tmp_path: Path) -> None:
    labels.append(tmp_path, [Label("a", LabelKind.NOTE, "from a clock that was ahead", 5000)])
    command = [sys.executable, "-c", SAY, str(tmp_path)]
    processes = [
        subprocess.Popen(
            [*command, name, str(COUNT)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        for name in ("Ana", "Ben")
    ]
    for process in processes:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("\n")
        process.stdin.flush()
    stamps = [int(word) for process in processes for word in process.communicate(timeout=120)[0].split()]
    assert [process.returncode for process in processes] == [0, 0]

    said = labels.read(tmp_path)[1:]
    assert sorted(set(stamps)) == sorted(stamps) == [5001 + number for number in range(2 * COUNT)]
    assert [label.at_ns for label in said if label.path == "a"] == sorted(stamps)
    assert {label.value for label in said} == {f"{name} {n}" for name in ("Ana", "Ben") for n in range(COUNT)}
    assert labels.read_folded(tmp_path)["a"].note == said[-1].value
