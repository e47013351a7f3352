"""The paper's own figures, as printed: Tables I, II and III, in per cent.

"Learning Multi-Arm Manipulation Through Collaborative Teleoperation", Tung, Wong, Mandlekar, Martín-Martín, Zhu,
Fei-Fei and Savarese, ICRA 2021, arXiv:2012.06738.

Its ± are population standard deviations over five seeds of the best checkpoint's success rate, 30 rollouts each, as far
as the printed digits tell: see docs/how-to-evaluate-policies.md.
"""

from __future__ import annotations

from collections.abc import Mapping

from mart.trainer.evaluate.statistics import Spread

CUBES = "two_arm_multi_cube_lifting"
TRAY = "two_arm_drink_tray_lifting"
ASSEMBLY = "two_arm_table_assembly"
HANDOVER = "two_arm_pick_place_handover"
WIPING = "three_arm_lift_wiping"

TITLES = {
    CUBES: "Multi-Cube Lifting",
    TRAY: "Drink-Tray Lifting",
    ASSEMBLY: "Table Assembly",
    HANDOVER: "Pick-Place Handover",
    WIPING: "Lifting Wiping",
}

# Table I, marginal success-rate degradation: task → uncoordinated, coordinated.
DEGRADATION: Mapping[str, tuple[float, float]] = {
    WIPING: (29.2, 38.2),
    HANDOVER: (33.8, 12.1),
    ASSEMBLY: (38.3, 12.6),
}

Results = Mapping[str, Mapping[str, Spread]]  # model → task → success rate


def _results(tasks: tuple[str, ...], rows: Mapping[str, tuple[tuple[float, float], ...]]) -> Results:
    return {
        model: {task: Spread(*cell) for task, cell in zip(tasks, row, strict=True)}
        for model, row in rows.items()
    }


# Table II, demonstrations of experienced operators.
EXPERIENCED: Results = _results(
    (CUBES, TRAY, ASSEMBLY, HANDOVER, WIPING),
    {
        "BC-RNN": ((34.1, 6.4), (50.0, 12.5), (0.0, 0.0), (2.0, 2.7), (56.0, 6.5)),
        "HBC": ((38.5, 3.8), (70.7, 3.3), (5.2, 3.0), (16.0, 3.9), (83.7, 6.5)),
        "d-HBC": ((84.5, 2.5), (72.6, 11.4), (4.9, 3.1), (24.4, 6.4), (50.0, 9.3)),
        "dh-HBC": ((41.3, 4.5), (55.3, 8.8), (1.3, 1.6), (15.3, 4.5), (62.0, 8.8)),
        "dl-HBC": ((58.0, 10.0), (55.3, 6.5), (5.3, 4.0), (10.7, 4.4), (55.3, 18.2)),
        "r-HBC": ((58.7, 4.5), (75.3, 5.8), (10.0, 2.1), (31.3, 4.0), (94.0, 2.5)),
        "rd-HBC": ((89.3, 3.3), (86.7, 3.0), (5.3, 2.7), (26.7, 4.7), (58.6, 1.6)),
    },
)

# Table III, demonstrations of the user study.
USER_STUDY: Results = _results(
    (ASSEMBLY, HANDOVER, WIPING),
    {
        "BC-RNN": ((0.0, 0.0), (0.0, 0.0), (48.7, 18.6)),
        "HBC": ((3.3, 2.1), (9.3, 5.3), (71.3, 6.5)),
        "d-HBC": ((1.1, 1.7), (4.4, 4.9), (33.3, 9.7)),
        "r-HBC": ((3.3, 2.1), (17.3, 5.3), (86.7, 5.2)),
    },
)
