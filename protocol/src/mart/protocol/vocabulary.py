"""Name the kinds of things that every part speaks of: services, operators, outcomes, verdicts.

Each is the word that stands on the wire, in files, in JSON and on the command line.
"""

from __future__ import annotations

from enum import StrEnum


class ServiceKind(StrEnum):
    """Name the kind of a running process, as in its liveliness key `mart/@live/{kind}/{id}`."""

    ROUTER = "router"
    PLATFORM = "platform"
    SIM = "sim"
    REPLICA = "replica"
    EXPERTS = "experts"
    GATEWAY = "gateway"
    SEAT = "seat"
    RECORDER = "recorder"
    CATALOGUE = "catalogue"
    TRAINER = "trainer"
    POLICIES = "policies"
    OPERATE = "operate"  # one policy in one seat, by hand
    DRIVER = "driver"  # of an arm that is not simulated
    CAMERA = "camera"  # a real one of a room
    PHONE = "phone"  # an emulated one
    WEB = "web"
    TURN = "turn"  # coturn, which says nothing on the bus


class OperatorKind(StrEnum):
    """Name who drives an arm; `hold` is nobody: the arm holds still and the barrier does not wait for it.

    `generated` is in files alone: a way made of recorded ones, which no seat ever has.
    """

    HUMAN = "human"
    POLICY = "policy"
    SCRIPT = "script"
    HOLD = "hold"
    GENERATED = "generated"


class EpisodeOutcome(StrEnum):
    """Name how an episode ended; `unspecified` where nothing says so, as in a file that a crash has cut."""

    UNSPECIFIED = "unspecified"
    SUCCESS = "success"
    FAILURE = "failure"
    DISCARDED = "discarded"


class EpisodeEndedBy(StrEnum):
    """Name what brought an episode to its end."""

    TASK = "task"  # it was done, or could no longer be
    TIME = "time"  # the time limit passed
    OPERATOR = "operator"  # somebody said so
    ABSENCE = "absence"  # everybody left
    ROOM = "room"  # the world could not go on


class Verdict(StrEnum):
    """Name what re-simulation said about an episode file."""

    VERIFIED = "verified"  # every recorded tick follows from the one before, bit for bit
    DIVERGED = "diverged"
    UNVERIFIED = "unverified"  # nobody could say, or a part could not be checked
    REAL = "real"  # not re-simulated: arms in it were measured


GOOD_VERDICTS = (Verdict.VERIFIED, Verdict.REAL)  # of episodes to learn from and to count
