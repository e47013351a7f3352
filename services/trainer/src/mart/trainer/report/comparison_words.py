"""Put the comparison of two runs into words, and into plain data."""

from __future__ import annotations

from typing import Any

from mart.trainer.evaluate.comparison import PairedComparison


def in_lines(found: PairedComparison) -> str:
    """Return a comparison in lines: the difference, both p-values with what they are of, and a warning of few seeds."""
    low, high = (100 * bound for bound in found.interval)
    pairs = found.seeds * found.worlds
    lines = [
        f"{found.first} (A) and {found.second} (B), {found.seeds} seeds in {found.worlds} worlds, {pairs} pairs",
        f"  A succeeds {100 * found.difference.value:+.1f} points more often ({low:+.1f} to {high:+.1f})",
        f"  alone: A in {found.only_first}, B in {found.only_second}",
        f"  p = {found.p_value:.3g} that trainings like these differ, over seeds and worlds",
        f"  p = {found.mcnemar_p:.3g} that these very policies differ, over worlds (McNemar's exact test)",
    ]
    if found.seeds == 1:
        lines.append(
            "  One seed: the first p-value and the interval are of its worlds alone; another may differ."
        )
    return "\n".join(lines)


def as_plain_data(found: PairedComparison) -> dict[str, Any]:
    """Return a comparison as plain data, rates as shares."""
    return {
        "first": found.first,
        "second": found.second,
        "seeds": found.seeds,
        "worlds": found.worlds,
        "difference": found.difference.value,
        "interval": list(found.interval),
        "only_first": found.only_first,
        "only_second": found.only_second,
        "p_value": found.p_value,
        "mcnemar_p": found.mcnemar_p,
    }
