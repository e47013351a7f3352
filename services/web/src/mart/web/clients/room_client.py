"""What people want of a room's seats and episode, asked of its sim, whose answer is the newest word of the room."""

from __future__ import annotations

from mart.protocol import clock, keys
from mart.protocol.holders import is_held_by
from mart.protocol.messages import (
    OPERATOR_HUMAN,
    EpisodeRequest,
    Operator,
    Outcome,
    RoomReply,
    Seat,
    SeatRequest,
)
from mart.runtime.ask import ask_async
from mart.runtime.bus.aio import AsyncBus
from mart.web.access.user_sessions import User
from mart.web.lobby.lobby import Lobby

_TIMEOUT_S = 5.0


class RoomRequester:
    """Requests to the sims of rooms.

    Each raises NotFound where the room or the arm does not exist, Unavailable where its sim does not answer, and what
    the sim reports: Forbidden where the user has no say, Conflict where somebody is in the way.
    """

    def __init__(self, bus: AsyncBus, lobby: Lobby) -> None:
        self._bus, self._lobby = bus, lobby

    async def take_seat(self, room: str, arm: str, user: User) -> Seat:
        """Give the seat of `arm` to `user`, also from a machine that drives it; return it."""
        claim = SeatRequest.Claim(
            arm=arm,
            holder_id=user.holder_id,
            name=user.name,
            operator=OPERATOR_HUMAN,
            passed_course=user.passed_course,
        )
        return await self._ask_seat(room, arm, SeatRequest(claim=claim))

    async def leave_seat(self, room: str, arm: str, user: User) -> Seat:
        """Free the seat of `arm` that `user` holds; return it."""
        release = SeatRequest.Release(arm=arm, holder_id=user.holder_id)
        return await self._ask_seat(room, arm, SeatRequest(release=release))

    async def assign_seat(self, room: str, arm: str, operator: Operator, policy: str) -> Seat:
        """Give the seat of `arm`, which no human holds, to a machine or to nobody; return it.

        Name the promoted one in `policy` where the operator is a policy.
        """
        assign = SeatRequest.Assign(arm=arm, operator=operator, policy=policy)
        return await self._ask_seat(room, arm, SeatRequest(assign=assign))

    async def hand_back_seat(self, room: str, arm: str, user: User) -> Seat:
        """Give the seat of `arm` back to the machine from which `user` took over; return it."""
        hand_back = SeatRequest.HandBack(arm=arm, holder_id=user.holder_id)
        return await self._ask_seat(room, arm, SeatRequest(hand_back=hand_back))

    async def set_ready(self, room: str, arm: str, user: User, ready: bool) -> None:
        """Say for the seat of `arm` that its operator is ready for the next episode, or is not."""
        seat = self._lobby.rooms.seat(room, arm, clock.monotonic_s())
        if ready and user.passed_course and not seat.passed_course and is_held_by(seat, user.holder_id):
            await self.take_seat(room, arm, user)  # they have passed the course since they sat down
        request = EpisodeRequest.Ready(arm=arm, holder_id=self._speaker(room, user), ready=ready)
        await self._ask_episode(room, EpisodeRequest(ready=request))

    async def finish_episode(self, room: str, user: User, outcome: Outcome) -> None:
        """End the running recording with `outcome`."""
        request = EpisodeRequest.Finish(holder_id=self._speaker(room, user), outcome=outcome)
        await self._ask_episode(room, EpisodeRequest(finish=request))

    async def reset_world(self, room: str, user: User) -> None:
        """Go back to practice with a fresh world."""
        request = EpisodeRequest.Reset(holder_id=self._speaker(room, user))
        await self._ask_episode(room, EpisodeRequest(reset=request))

    async def stop(self, room: str, holder_id: str, name: str) -> None:
        """Stop everything in the room, as `name`; once is enough."""
        await self._ask_episode(
            room, EpisodeRequest(stop=EpisodeRequest.Stop(holder_id=holder_id, name=name))
        )

    async def let_go_of_stop(self, room: str, name: str) -> None:
        """Let everything go on in the room, as `name`."""
        await self._ask_episode(room, EpisodeRequest(go_on=EpisodeRequest.GoOn(name=name)))

    async def free_seat(self, room: str, arm: str, host: User) -> Seat:
        """Free the seat of `arm`, whoever sits there, for a host; return it."""
        return await self._ask_seat(room, arm, SeatRequest(free=SeatRequest.Free(arm=arm, name=host.name)))

    async def finish_for_all(self, room: str, host: User, outcome: Outcome) -> None:
        """End the running recording with `outcome`, for a host."""
        await self._ask_episode(
            room, EpisodeRequest(finish=EpisodeRequest.Finish(outcome=outcome, host=host.name))
        )

    async def reset_for_all(self, room: str, host: User) -> None:
        """Go back to practice with a fresh world, for a host."""
        await self._ask_episode(room, EpisodeRequest(reset=EpisodeRequest.Reset(host=host.name)))

    async def pause(self, room: str, host: User) -> None:
        """Pause the room until a host lets it go on."""
        stop = EpisodeRequest.Stop(holder_id=host.holder_id, name=host.name, by_host=True)
        await self._ask_episode(room, EpisodeRequest(stop=stop))

    async def end_pause(self, room: str, host: User) -> None:
        """Let the room go on, whoever stopped or paused it."""
        go_on = EpisodeRequest.GoOn(name=host.name, by_host=True)
        await self._ask_episode(room, EpisodeRequest(go_on=go_on))

    async def set_plan(self, room: str, host: User, episodes: int) -> None:
        """Plan so many good episodes from now on; 0: no plan."""
        plan = EpisodeRequest.SetPlan(episodes=episodes, name=host.name)
        await self._ask_episode(room, EpisodeRequest(set_plan=plan))

    async def require_course(self, room: str, host: User, *, required: bool) -> None:
        """Let people record only who have passed the practice course, or everybody."""
        word = EpisodeRequest.RequireCourse(required=required, name=host.name)
        await self._ask_episode(room, EpisodeRequest(require_course=word))

    def _speaker(self, room: str, user: User) -> str:
        """Whoever holds no seat speaks as anybody: the sim hears them where no human drives."""
        seats = self._lobby.rooms.status(room, clock.monotonic_s()).seats
        return user.holder_id if any(is_held_by(seat, user.holder_id) for seat in seats) else ""

    async def _ask_seat(self, room: str, arm: str, request: SeatRequest) -> Seat:
        self._lobby.rooms.seat(room, arm, clock.monotonic_s())
        reply = await self._ask(keys.seat(room), request)
        return reply.seat if reply.seat.arm else self._lobby.rooms.seat(room, arm, clock.monotonic_s())

    async def _ask_episode(self, room: str, request: EpisodeRequest) -> None:
        self._lobby.rooms.status(room, clock.monotonic_s())
        await self._ask(keys.episode(room), request)

    async def _ask(self, topic: keys.Topic, request: SeatRequest | EpisodeRequest) -> RoomReply:
        reply = await ask_async(self._bus, topic, request, RoomReply, timeout_s=_TIMEOUT_S)
        if reply.status.room:
            self._lobby.see_status(reply.status, clock.monotonic_s())
        return reply
