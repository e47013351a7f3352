"""One person goes from arm to arm: the arm that is left holds or goes to its machine, and their phone goes along."""

from __future__ import annotations

from typing import Any

import pytest

from mart.protocol.messages import (
    EPISODE_PHASE_RECORDING,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
)
from mart.web.api.app_state import AppState
from tests.web.api.test_signaling import phone_of, renewed
from tests.web.conftest import Client, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio
SEATS = "/api/rooms/room-1/seats"


async def switched(person: Client, arm: str) -> tuple[int, dict[str, Any]]:
    answer = await person.post(f"{SEATS}/{arm}/switch")
    told = answer.json()
    return answer.status_code, told.get("seat") or told["error"]


def operators(room: Room) -> list[int]:
    return [seat.operator for seat in room.seats]


async def test_the_arm_that_is_left_holds_still_and_goes_back_to_its_machine(
    enter: Enter, room: Room
) -> None:
    ana = await enter("Ana")
    await ana.post(f"{SEATS}/arm1", json={"operator": "script"})
    await ana.post(f"{SEATS}/arm0", json={"operator": "human"})
    status, seat = await switched(ana, "arm0")
    assert (status, seat["arm"]) == (200, "arm1")
    assert seat["mine"]
    assert operators(room) == [OPERATOR_HOLD, OPERATOR_HUMAN]
    status, seat = await switched(ana, "arm1")
    assert (status, seat["arm"]) == (200, "arm0")
    assert operators(room) == [OPERATOR_HUMAN, OPERATOR_SCRIPT]


async def test_where_people_drive_all_others_one_stays(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    await ana.post(f"{SEATS}/arm0", json={"operator": "human"})
    assert (await switched(ben, "arm0"))[0] == 403
    await ben.post(f"{SEATS}/arm1", json={"operator": "human"})
    status, error = await switched(ana, "arm0")
    assert (status, error["code"]) == (409, "Conflict")
    assert operators(room) == [OPERATOR_HUMAN, OPERATOR_HUMAN]


async def test_a_phone_goes_along_and_may_ask_for_it(enter: Enter, room: Room, app_state: AppState) -> None:
    ana, phone = await enter("Ana"), await enter()
    await ana.post(f"{SEATS}/arm0", json={"operator": "human"})
    token = await phone_of(ana, phone)
    assert (await switched(ana, "arm0"))[0] == 200
    status, told = await renewed(phone, token)
    assert (status, told["arm"]) == (200, "arm1")
    assert told["epoch"] == room.seats["arm1"].epoch
    headers = {"Authorization": f"Bearer {told['token']}"}
    assert (await phone.post(f"{SEATS}/arm1/phone-switch", headers=headers)).json() == {"arm": "arm0"}
    status, told = await renewed(phone, token)
    assert (status, told["arm"]) == (200, "arm0")
    refused = await phone.post(f"{SEATS}/arm1/phone-switch", headers=headers)
    assert refused.status_code == 403  # nobody of theirs sits there


async def test_an_episode_goes_on(enter: Enter, room: Room) -> None:
    """There is no moment in which nobody sits there, which would discard it."""
    ana = await enter("Ana")
    await ana.post(f"{SEATS}/arm0", json={"operator": "human"})
    room.course.phase = EPISODE_PHASE_RECORDING
    room.publish()
    for arm in ("arm0", "arm1", "arm0"):
        assert (await switched(ana, arm))[0] == 200
    assert room.course.phase == EPISODE_PHASE_RECORDING
