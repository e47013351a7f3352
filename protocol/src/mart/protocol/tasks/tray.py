"""What carriers of the tray of drinks see: the same in every task that has one."""

from __future__ import annotations

from mart.protocol.tasks.task import Observation

CARRIERS = ("arm0", "arm1")
DRINKS = 4


def tray_observations(watchers: tuple[str, ...]) -> tuple[Observation, ...]:
    """The tray for every watcher; drinks, handles and the partner's tool for those who carry it."""
    handles = (Observation(f"{handle_of(arm)}/position_in_world", (3,), "m", CARRIERS) for arm in CARRIERS)
    tools = (Observation(f"{partner_of(arm)}/tool_position_in_world", (3,), "m", (arm,)) for arm in CARRIERS)
    return (
        Observation("tray/position_in_world", (3,), "m", watchers),
        Observation("tray/quaternion_in_world", (4,), "wxyz", watchers),
        Observation("drinks/positions_in_world", (3 * DRINKS,), "m", CARRIERS),
        *handles,
        *tools,
    )


def handle_of(arm: str) -> str:
    return arm.replace("arm", "handle")


def partner_of(arm: str) -> str:
    first, second = CARRIERS
    return second if arm == first else first
