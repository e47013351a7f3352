"""Worlds stepped over the bus: what a trainer, an evaluation or a collection has instead of a simulator.

A batch is spread over several replicas (`mart replica`), which are asked at the same time. Every replica's worlds are
independent of the others', and a world's course depends on its seed and its actions only, not on how a batch was split.
"""

from __future__ import annotations

import contextlib
import operator
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from mart.protocol import codec, keys
from mart.protocol.batch_state import ACTION_SIZE, BatchState, Flags, join, pack_actions, unpack
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.errors import Conflict, InvalidInput, MartError, Unavailable
from mart.protocol.messages import Model, RolloutReply, RolloutRequest, raise_error
from mart.protocol.received import decode_received
from mart.protocol.tasks import Task, get_task
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus import Bus

__all__ = ["ACTION_SIZE", "BatchState", "RolloutClient"]

_START_TIMEOUT_S = 5.0
_RESET_TIMEOUT_S, _RESET_TIMEOUT_PER_WORLD_S = 60.0, 0.1
_STEP_TIMEOUT_S, _STEP_TIMEOUT_PER_WORLD_S = 30.0, 0.05
_CLOSE_TIMEOUT_S = 2.0
_SEEDS = 2**64


@dataclass(frozen=True)
class _Share:
    """The worlds from `first` to before `end` are one session of one replica."""

    replica: str
    first: int
    end: int
    session: str = ""


class RolloutClient:
    """Worlds on the replicas of these names. Not for several threads at once.

    Whatever goes wrong during `reset` or `step`, the worlds of a client that raised another error than InvalidInput are
    gone: `reset` again.
    """

    def __init__(self, bus: Bus, replicas: Sequence[str]) -> None:
        """Use these replicas. Raises InvalidInput without any, or where one is named twice."""
        if not replicas or len(set(replicas)) < len(replicas):
            raise InvalidInput(
                f"Replicas {', '.join(replicas) or 'of no name'} were given; name each of them, once."
            )
        self._bus = bus
        self._replicas = tuple(replicas)
        self._executor = ThreadPoolExecutor(len(replicas), thread_name_prefix="rollout")
        self._shares: list[_Share] = []
        self._task: Task | None = None
        self._steps = 0
        self._busy = threading.Lock()

    def reset(
        self,
        task: str,
        seeds: Sequence[int],
        control_hz: float = DEFAULT_CONTROL_HZ,
        arms: int | None = None,
        *,
        arm_kinds: Sequence[str] = (),
        integration_states: bool = False,
    ) -> BatchState:
        """Begins an episode in one world for each seed; earlier worlds of this client are closed.

        arm_kinds: one for each arm, such as a task's `arm_kinds`; none of them: Pandas.

        Raises NotFound for an unknown task, InvalidInput where seeds, rate or arms cannot be, Unavailable where a
        replica does not answer or cannot hold its share.
        """
        known, seeds = get_task(task, arms, arm_kinds), _whole(seeds)
        with self._alone():
            self._close_shares()
            self._require_replicas()
            timeout_s = _RESET_TIMEOUT_S + _RESET_TIMEOUT_PER_WORLD_S * len(seeds)
            calls = []
            for share in _split(len(seeds), self._replicas):
                begin = RolloutRequest.Reset(
                    task=task,
                    control_hz=control_hz,
                    arms=arms or 0,
                    arm_kinds=arm_kinds,
                    seeds=seeds[share.first : share.end],
                    integration_states=integration_states,
                )
                calls.append(partial(self._open, share, RolloutRequest(reset=begin), timeout_s))
            replies = self._all(calls)
            self._task, self._steps = known, 0
            self._shares.sort(key=operator.attrgetter("first"))
            return self._unpack(known, replies)

    def step(self, actions: ArrayLike, running: ArrayLike | None = None) -> BatchState:
        """Advances every world by one control period, or those that are `running`, shape (B,); the others stay.

        actions: shape (B, arms, 7), each number in [-1, 1]. Raises InvalidInput for anything else, and nothing moves;
        Conflict before a reset; NotFound where a replica has forgotten its worlds; Unavailable where one is gone.
        """
        with self._alone():
            task, worlds = self._require_worlds()
            packed = pack_actions(actions, (worlds, len(task.arms), ACTION_SIZE))
            going = np.ones(worlds, bool) if running is None else _running(running, worlds)
            timeout_s = _STEP_TIMEOUT_S + _STEP_TIMEOUT_PER_WORLD_S * worlds
            calls = []
            for share in self._shares:
                step = RolloutRequest.Step(
                    session=share.session,
                    actions=packed[share.first : share.end].tobytes(),
                    running=going[share.first : share.end].tobytes(),
                    number=self._steps + 1,
                )
                calls.append(partial(self._query, share.replica, RolloutRequest(step=step), timeout_s))
            replies = self._all(calls)
            self._steps += 1
            return self._unpack(task, replies)

    def model(
        self,
        task: str,
        control_hz: float = DEFAULT_CONTROL_HZ,
        arms: int | None = None,
        arm_kinds: Sequence[str] = (),
    ) -> Model:
        """What such worlds are compiled to. Raises as `reset`; worlds that there are stay as they are."""
        describe = RolloutRequest.Describe(
            task=task, control_hz=control_hz, arms=arms or 0, arm_kinds=arm_kinds
        )
        with self._alone():
            self._require_replicas()
            return self._query(self._replicas[0], RolloutRequest(describe=describe), _RESET_TIMEOUT_S).model

    def close(self) -> None:
        """Lets go of the worlds. The bus stays open."""
        with self._alone():
            self._close_shares()
        self._executor.shutdown()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        if not self._busy.acquire(blocking=False):
            raise Conflict("These worlds are in the middle of a step or a reset; wait until it has returned.")
        try:
            yield
        finally:
            self._busy.release()

    def _require_replicas(self) -> None:
        """Waits a little: a replica that is just starting may be up for others already, or the router is."""
        awaited = {keys.alive(ServiceKind.REPLICA, replica) for replica in self._replicas}
        found = await_alive(self._bus, keys.alive_of(ServiceKind.REPLICA), awaited, _START_TIMEOUT_S)
        up = {keys.last_of(key) for key in found}
        for replica in self._replicas:
            if replica not in up:
                raise Unavailable(
                    f"No replica {replica!r} is up (up: {', '.join(sorted(up)) or 'none'}); "
                    f"start it with `mart replica --name {replica}`."
                )

    def _require_worlds(self) -> tuple[Task, int]:
        if self._task is None or not self._shares:
            raise Conflict("There are no worlds to step: none were reset, or they were lost; reset them.")
        return self._task, self._shares[-1].end

    def _open(self, share: _Share, request: RolloutRequest, timeout_s: float) -> RolloutReply:
        reply = self._query(share.replica, request, timeout_s)
        self._shares.append(replace(share, session=reply.session))
        return reply

    def _all(self, calls: Sequence[Callable[[], RolloutReply]]) -> list[RolloutReply]:
        """At the same time. Where one fails, the worlds of all are let go: they no longer belong together."""
        first, *others = calls
        futures = [self._executor.submit(call) for call in others]
        try:
            try:
                reply = first()
            finally:
                wait(futures)
            return [reply, *(future.result() for future in futures)]
        except MartError:
            self._close_shares()
            raise

    def _query(self, replica: str, request: RolloutRequest, timeout_s: float) -> RolloutReply:
        answer = self._bus.query(keys.rollout(replica), codec.encode(request), timeout_s)
        reply = decode_received(RolloutReply, answer)
        raise_error(reply.error)
        return reply

    def _close_shares(self) -> None:
        """A replica that does not answer is gone, and its worlds with it, or will forget them."""
        shares, self._shares = self._shares, []
        for share in shares:
            request = RolloutRequest(close=RolloutRequest.Close(session=share.session))
            with contextlib.suppress(MartError):
                self._query(share.replica, request, _CLOSE_TIMEOUT_S)

    def _unpack(self, task: Task, replies: Sequence[RolloutReply]) -> BatchState:
        parts = [
            unpack(task, reply.worlds, share.end - share.first)
            for share, reply in zip(self._shares, replies, strict=True)
        ]
        return join(parts)


def _split(worlds: int, replicas: Sequence[str]) -> list[_Share]:
    """Even shares; with fewer worlds than replicas, some get none."""
    bounds = [worlds * i // len(replicas) for i in range(len(replicas) + 1)]
    shares = [_Share(*share) for share in zip(replicas, bounds, bounds[1:], strict=False)]
    return [share for share in shares if share.end > share.first]


def _whole(seeds: Sequence[int]) -> list[int]:
    """Raises InvalidInput where there is none, or one is not a whole number that the wire can carry."""
    if not len(seeds):
        raise InvalidInput("No seeds were given; give one for each world.")
    for seed in seeds:
        if int(seed) != seed or not 0 <= seed < _SEEDS:
            raise InvalidInput(f"Seed {seed!r} was given; a seed is a whole number from 0 to 2**64 - 1.")
    return [int(seed) for seed in seeds]


def _running(running: ArrayLike, worlds: int) -> Flags:
    flags = np.asarray(running)
    if flags.shape != (worlds,) or flags.dtype != np.bool_:
        raise InvalidInput(
            f"`running` of shape {flags.shape}, {flags.dtype}, was given; give a flag for each of {worlds} worlds."
        )
    return flags
