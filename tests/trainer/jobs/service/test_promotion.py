from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.errors import NotFound
from mart.trainer.jobs.service.promotion import FILE, policies, withdraw


@pytest.mark.parametrize("record", [b"", b"{", b"\xff\xfe", b"[" * 100_000, b'{"updates": 1e999}', b"[]"])
def test_a_damaged_record_costs_its_own_policy_only(tmp_path: Path, record: bytes) -> None:
    for name, content in (("good", b'{"name": "good", "task": "lift"}'), ("bad", record)):
        (tmp_path / name).mkdir()
        (tmp_path / name / FILE).write_bytes(content)
    assert [policy.name for policy in policies(tmp_path)] == ["good"]
    assert withdraw(tmp_path, "bad").name == "bad"
    assert [path.name for path in tmp_path.iterdir()] == ["good"]
    with pytest.raises(NotFound):
        withdraw(tmp_path, "bad")
