"""How long a fuzz test goes on: seconds with all the others, minutes by hand with `--hypothesis-profile fuzz`."""

from __future__ import annotations

from hypothesis import HealthCheck, Phase, settings

PROFILE = "fuzz"
_LONGER = 50  # times
_PHASES = (Phase.explicit, Phase.reuse, Phase.generate, Phase.shrink)


def fuzzing(examples: int) -> settings:
    """Return how to run a fuzz test that tries so many examples with all the others."""
    longer = _LONGER if settings.get_current_profile_name() == PROFILE else 1
    unhurried = [HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large]
    return settings(max_examples=examples * longer, suppress_health_check=unhurried, phases=_PHASES)
