"""Keep what a later verification said: as a label, because files never change."""

from __future__ import annotations

from pathlib import Path

from mart.episodes import labels
from mart.episodes.folder import described
from mart.protocol.recording import VerificationRecord
from mart.protocol.vocabulary import Verdict


def keep_verdict(path: Path, said: VerificationRecord, at_ns: int) -> bool:
    """Label an episode file with a verdict; return whether that was done. at_ns: Unix time.

    What could not be had takes nothing back, and a machine that cannot tell takes back no `verified` of one that could.
    """
    if said.pending:
        return False
    if said.verdict is Verdict.UNVERIFIED and any(one.verified for one in described([path])):
        return False
    labels.say(path, labels.LabelKind.VERDICT, said.verdict.value, at_ns, said.detail)
    return True
