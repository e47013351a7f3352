"""How large a reproduction is: what each preset takes, which models and tasks each table has, who the users are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

CUBES, TRAY = "two_arm_multi_cube_lifting", "two_arm_drink_tray_lifting"
ASSEMBLY, HANDOVER = "two_arm_table_assembly", "two_arm_pick_place_handover"
WIPING = "three_arm_lift_wiping"

# The paper's tables, by rows and columns.
MIXED_TASKS = (ASSEMBLY, HANDOVER, WIPING)
ALL_TASKS = (CUBES, TRAY, *MIXED_TASKS)
TABLE_TASKS: Mapping[str, tuple[str, ...]] = {
    "table1": MIXED_TASKS,
    "table2": ALL_TASKS,
    "table3": MIXED_TASKS,
}
TABLE_MODELS: Mapping[str, tuple[str, ...]] = {
    "table1": (),
    "table2": ("BC-RNN", "HBC", "d-HBC", "dh-HBC", "dl-HBC", "r-HBC", "rd-HBC"),
    "table3": ("BC-RNN", "HBC", "d-HBC", "r-HBC"),
}
BASES: Mapping[str, str] = {"r-HBC": "d-HBC", "rd-HBC": "HBC"}  # whose runs a residual corrects


@dataclass(frozen=True)
class UserGroup:
    """People who collect together, an arm each. people: as `mart collect --skill` takes them, an arm after the other.

    The paper's study had three pairs for the two-arm tasks and two trios for the three-arm one, of varying experience.
    """

    name: str
    people: str


PAIRS = (
    UserGroup("pair-a", "ada=careful,ben=hasty"),
    UserGroup("pair-b", "cleo=average,dan=impatient"),
    UserGroup("pair-c", "eva=learning,finn=average"),
)
TRIOS = (
    UserGroup("trio-a", "ada=careful,ben=careful,cleo=hasty"),
    UserGroup("trio-b", "dan=average,eva=impatient,finn=learning"),
)


def groups_of(task: str) -> tuple[UserGroup, ...]:
    """Return who takes part in the user study of a task."""
    return TRIOS if task == WIPING else PAIRS


@dataclass(frozen=True)
class Sizes:
    """What a preset takes. episodes: of a task, for each table's data. skill: of experienced operators.

    train: options of `mart train`; long: more of them, for the tasks of several stages, whose episodes are long.
    judged, scored: episodes of a checkpoint, and of the best one in fresh worlds. held_out: share of the episodes.
    """

    seeds: int
    episodes: int
    skill: str
    train: tuple[str, ...]
    judged: int
    scored: int
    held_out: float
    long: tuple[str, ...] = ()


PRESETS: Mapping[str, Sizes] = {
    "debug": Sizes(1, 4, "expert", ("--preset", "debug", "--outcome", "any"), 2, 2, 0.25),
    "fast": Sizes(
        *(3, 100, "average", ("--preset", "fast"), 30, 100, 0.1),
        long=("--set", "updates=8000", "--set", "checkpoints=2"),
    ),
    "paper": Sizes(5, 100, "average", ("--preset", "paper", "--device", "auto"), 30, 100, 0.1),
}
EPISODES_AT_ONCE = 25  # of a collection: what a kill may cost
COLLECTION_SEED = 1000
