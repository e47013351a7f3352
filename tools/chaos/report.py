"""Write the rows as the table of docs/reliability.md, between its two marks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tools.chaos.row import Row

_BEGIN, _END = "<!-- chaos: begin -->", "<!-- chaos: end -->"
_HEAD = (
    "| fault | world stands | told after | told | lost | the episode's files | next episode | left | falls short |\n"
    "|---|---|---|---|---|---|---|---|---|\n"
)


def write_table(page: Path, rows: Sequence[Row]) -> None:
    """Replace what stands between the marks."""
    if not page.exists():
        return
    before, _, rest = page.read_text().partition(_BEGIN)
    _, _, after = rest.partition(_END)
    page.write_text(f"{before}{_BEGIN}\n{table(rows)}{_END}{after}")


def table(rows: Sequence[Row]) -> str:
    """Return the rows as a table."""
    return _HEAD + "".join(f"| {' | '.join(map(_cell, _cells(row)))} |\n" for row in rows)


def _cells(row: Row) -> list[str]:
    if row.not_here:
        return [row.fault, f"not tried: {row.not_here}", "", "", "", "", "", "", ""]
    start = "" if row.next_start_s is None else f"; next start {row.next_start_s:.0f} s"
    return [
        row.fault,
        f"{row.standstill_s:.1f} s" if row.back_s else "not felt",
        "" if row.told_s is None else f"{row.told_s:.1f} s",
        row.told,
        f"{row.lost_s:.1f} s" if row.lost_s else "nothing",
        row.episode,
        ("verified" if row.next_verified else "not verified") + start,
        str(row.left_over) if row.left_over else "nothing",
        "; ".join(row.short),
    ]


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")[:200]
