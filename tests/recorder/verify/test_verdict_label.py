"""A later verdict becomes a label, unless it could not be had, or knows less than the one before."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes.folder import list_episodes
from mart.protocol.recording import VerificationRecord
from mart.protocol.vocabulary import Verdict
from mart.recorder.verify.verdict_label import keep_verdict
from tests.recorder.files import write_episode


@pytest.mark.parametrize(
    ("verdict", "pending", "kept", "holds"),
    [
        (Verdict.DIVERGED, False, True, Verdict.DIVERGED),
        (Verdict.VERIFIED, False, True, Verdict.VERIFIED),
        (Verdict.UNVERIFIED, False, False, Verdict.VERIFIED),
        (Verdict.UNVERIFIED, True, False, Verdict.VERIFIED),
    ],
)
def test_what_holds_after_a_later_verdict_about_a_verified_file(
    *, tmp_path: Path, verdict: Verdict, pending: bool, kept: bool, holds: Verdict
) -> None:
    path = write_episode(tmp_path, 3).path
    said = VerificationRecord(verdict=verdict, detail="why", pending=pending)
    assert keep_verdict(path, said, 1) is kept
    assert list_episodes(path)[0].verdict == holds
