"""Name what is measured of an episode: for each arm, and for all of it. Units stand in the names."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel, ConfigDict


class ArmQuality(BaseModel):
    """Hold what is measured of one arm, over what is left of the episode after its edits; None where it has none.

    log_dimensionless_jerk: smoothness of the tool's way, nearer to 0 is smoother.
    idle_s, idle_share: it stood still for at least a second.
    path_m, path_rad: how far the tool went and turned. path_ratio: its way over the straight one by way of the places
    where its gripper closed or opened.
    regrasps: how often its gripper was closed again. engagements: how often its clutch was pressed.
    held_share: ticks in which no new command of its operator's was there. late_share: ticks that waited for it.
    waited_s: how long the room waited for it. phone_losses: how often the phone, or controller, that led it lost its
    tracking or was somewhere else at once. phone_lost_s, phone_lost_share: for how long, in whole ticks.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    log_dimensionless_jerk: float | None = None
    idle_s: float = 0.0
    idle_share: float = 0.0
    path_m: float = 0.0
    path_rad: float = 0.0
    path_ratio: float | None = None
    regrasps: int = 0
    engagements: int = 0
    held_share: float = 0.0
    late_share: float = 0.0
    waited_s: float = 0.0
    phone_losses: int = 0
    phone_lost_s: float = 0.0
    phone_lost_share: float = 0.0


class EpisodeQuality(BaseModel):
    """Hold what is measured of one episode; None where the file does not say.

    duration_s: simulated seconds that are left of it after its edits. idle_s, idle_share: no arm moved for at least a
    second. waited_s, waited_share: how long the room waited for somebody, on the wall's clock, and of which share.
    video_gap_s: the longest pause between two pictures of one camera. video_gap_share: the share of the time that lies
    in pauses of more than three pictures, of the camera that has most.
    link_losses: how often a seat's link was said to be broken. stops: emergency stops.
    subtask_s: by name, when it was first done, simulated seconds from the beginning.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    duration_s: float
    idle_s: float
    idle_share: float
    waited_s: float
    waited_share: float
    real_time_factor: float | None = None
    missing_ticks: int = 0
    missing_commands: int | None = None
    video_gap_s: float | None = None
    video_gap_share: float | None = None
    link_losses: int = 0
    stops: int = 0
    subtask_s: dict[str, float] = {}
    arms: dict[str, ArmQuality] = {}

    def numbers(self) -> Iterator[tuple[str, str, float]]:
        """Iterate over all that is a number: (arm, measure, value); the arm is empty for what is of the episode."""
        for name, value in self.model_dump(exclude={"arms", "subtask_s"}).items():
            if value is not None:
                yield "", name, float(value)
        for name, seconds in self.subtask_s.items():
            yield "", f"subtask_s.{name}", seconds
        for arm, own in self.arms.items():
            for name, value in own.model_dump().items():
                if value is not None:
                    yield arm, name, float(value)
