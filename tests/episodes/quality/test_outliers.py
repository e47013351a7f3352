from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.quality import MIN_EPISODES, ArmQuality, EpisodeQuality, outliers, typical


def quality(duration_s: float = 10.0, regrasps: int = 1, jerk: float = -7.0) -> EpisodeQuality:
    arm = ArmQuality(regrasps=regrasps, log_dimensionless_jerk=jerk)
    return EpisodeQuality(
        duration_s=duration_s, idle_s=0, idle_share=0, waited_s=0, waited_share=0, arms={"arm0": arm}
    )


USUAL = typical([quality(10.0 + i / 10) for i in range(12)])


def test_an_episode_like_the_others_is_no_outlier() -> None:
    assert outliers(quality(), USUAL) == []


def test_what_is_far_to_the_worse_is_told_with_its_reason_the_farthest_first() -> None:
    found = outliers(quality(38.0, regrasps=4, jerk=-9.0), USUAL)
    assert [(one.arm, one.name) for one in found] == [
        ("", "duration_s"),
        ("arm0", "log_dimensionless_jerk"),
        ("arm0", "regrasps"),
    ]
    assert [one.why for one in found] == [
        "3.6 times the median, 10.55 s",
        "-9, and the median is -7",
        "4.0 times the median, 1",
    ]


def test_better_than_usual_is_no_outlier() -> None:
    assert outliers(quality(1.0, regrasps=0, jerk=-2.0), USUAL) == []


def test_a_few_episodes_say_nothing_of_what_is_usual() -> None:
    assert typical([quality()] * (MIN_EPISODES - 1)) == {}
    assert outliers(quality(1000.0), {}) == []


@given(odd=st.lists(st.floats(1.0, 1e6), max_size=5))
def test_a_minority_of_odd_episodes_does_not_hide_one(odd: list[float]) -> None:
    usual = typical([quality(10.0)] * 6 + [quality(one) for one in odd])
    known = usual.get(("", "duration_s"))
    assert known is None or known.median == 10.0 or len(odd) == 5
    if known is not None:
        assert outliers(quality(50.0), usual)
