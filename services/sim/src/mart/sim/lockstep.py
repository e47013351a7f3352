"""Worlds stepped by requests, as fast as the machine allows: for training, evaluation and re-simulation.

The barrier's rule holds here too: a request carries an action for every arm of every world, so each world advances
exactly when all its arms have been told what to do. The worlds are those of the rooms; only what they are between two
requests is kept, as integration states, and any free world of the right kind continues any of them.
"""

from __future__ import annotations

import hashlib
import os
import queue
import secrets
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Conflict, InvalidInput, NotFound, Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest, WorldState
from mart.sim import publish
from mart.sim.world import ACTION_SIZE, Diverged, World

MAX_SESSIONS = 8
MAX_WORLDS = 256  # a session
MAX_TICKS = 100_000  # a re-simulation: over an hour at 20 Hz
IDLE_S = 600.0
_DIGEST_BYTES = 16

T = TypeVar("T")
Actions = NDArray[np.float64]


@dataclass(frozen=True)
class Kind:
    """What decides a world's model."""

    task: str
    control_hz: float
    arms: int | None


class WorldPool:
    """Worlds of one kind, as many as run at a time: physics runs without the interpreter's lock."""

    def __init__(self, kind: Kind, size: int) -> None:
        self._idle: queue.SimpleQueue[World] = queue.SimpleQueue()
        worlds = [World.build(kind.task, kind.control_hz, kind.arms) for _ in range(size)]
        for world in worlds:
            self._idle.put(world)
        self.arms = len(worlds[0].arms)
        self.model_sha256 = worlds[0].model_sha256

    def use(self, work: Callable[[World], T]) -> T:
        world = self._idle.get()
        try:
            return work(world)
        finally:
            self._idle.put(world)


@dataclass
class _Session:
    pool: WorldPool
    states: list[bytes]
    used_s: float


class Lockstep:
    """Answers rollout requests. Raises errors of the tree; `now_s` is monotonic."""

    def __init__(self, workers: int | None = None) -> None:
        self._workers = workers or os.cpu_count() or 1
        self._executor = ThreadPoolExecutor(self._workers)
        self._pools: dict[Kind, WorldPool] = {}
        self._sessions: dict[str, _Session] = {}

    def close(self) -> None:
        self._executor.shutdown()

    def answer(self, request: RolloutRequest, now_s: float) -> RolloutReply:
        self._forget_idle(now_s)
        match request.WhichOneof("what"):
            case "reset":
                return self._reset(request.reset, now_s)
            case "step":
                return self._step(request.step, now_s)
            case "close":
                self._session(request.close.session)
                del self._sessions[request.close.session]
                return RolloutReply(session=request.close.session)
            case "resimulate":
                return self._resimulate(request.resimulate)
        raise InvalidInput("An empty rollout request was given; ask for reset, step, close or resimulate.")

    def _reset(self, reset: RolloutRequest.Reset, now_s: float) -> RolloutReply:
        if not 1 <= len(reset.seeds) <= MAX_WORLDS:
            raise InvalidInput(
                f"{len(reset.seeds)} seeds were given; give 1 to {MAX_WORLDS}, one for each world."
            )
        if len(self._sessions) >= MAX_SESSIONS:
            raise Unavailable(
                f"{MAX_SESSIONS} sessions are open already; close one, or wait {IDLE_S:g} s of idleness."
            )
        pool = self._pool(Kind(reset.task, reset.control_hz, reset.arms or None))

        def begin(seed: int) -> WorldState:
            def reset_world(world: World) -> WorldState:
                world.reset(seed)
                return publish.world_state(world, None)

            return pool.use(reset_world)

        worlds = list(self._executor.map(begin, reset.seeds))
        name = secrets.token_hex(8)
        self._sessions[name] = _Session(pool, [world.integration_state for world in worlds], now_s)
        return RolloutReply(session=name, worlds=worlds)

    def _step(self, step: RolloutRequest.Step, now_s: float) -> RolloutReply:
        session = self._session(step.session)
        session.used_s = now_s
        actions = _actions(step.actions, (len(session.states), session.pool.arms, ACTION_SIZE))

        def advance(state: bytes, action: Actions) -> WorldState:
            return session.pool.use(lambda world: _advance(world, state, action))

        worlds = list(self._executor.map(advance, session.states, actions))
        session.states = [world.integration_state for world in worlds]
        return RolloutReply(session=step.session, worlds=worlds)

    def _resimulate(self, request: RolloutRequest.Resimulate) -> RolloutReply:
        pool = self._pool(Kind(request.task, request.control_hz, request.arms or None))
        if request.model_sha256 != pool.model_sha256:
            raise Conflict(
                f"A recording of model {request.model_sha256[:12]} was given, but this replica compiles "
                f"{request.task} to {pool.model_sha256[:12]}; use the versions that recorded it."
            )
        size = pool.arms * ACTION_SIZE * 8
        ticks = len(request.actions) // size
        if ticks > MAX_TICKS:
            raise InvalidInput(f"{ticks} ticks were given; at most {MAX_TICKS} are re-simulated at once.")
        actions = _actions(request.actions, (ticks, pool.arms, ACTION_SIZE))
        return RolloutReply(
            state_digests=pool.use(lambda world: _digests(world, request.first_state, actions))
        )

    def _session(self, name: str) -> _Session:
        if name not in self._sessions:
            raise NotFound(
                f"There is no session {name!r}: it was closed, or idle for {IDLE_S:g} s; reset to get one."
            )
        return self._sessions[name]

    def _pool(self, kind: Kind) -> WorldPool:
        if kind not in self._pools:
            self._pools[kind] = WorldPool(kind, self._workers)
        return self._pools[kind]

    def _forget_idle(self, now_s: float) -> None:
        idle = [name for name, session in self._sessions.items() if now_s - session.used_s > IDLE_S]
        for name in idle:
            del self._sessions[name]


def _advance(world: World, state: bytes, action: Actions) -> WorldState:
    """One world of a batch. One that leaves its bounds stays where it was, and says that it failed."""
    world.set_integration_state(state)
    try:
        world.step(action)
    except Diverged as error:
        world.set_integration_state(state)
        stuck = publish.world_state(world, action)
        stuck.progress.failed = str(error)
        return stuck
    return publish.world_state(world, action)


def _digests(world: World, first_state: bytes, actions: Actions) -> bytes:
    """Raises InvalidInput where `first_state` is not this model's, Diverged where the physics left its bounds."""
    world.set_integration_state(first_state)
    digests = []
    for action in actions:
        world.step(action)
        digests.append(hashlib.blake2b(world.integration_state(), digest_size=_DIGEST_BYTES).digest())
    return b"".join(digests)


def _actions(payload: bytes, shape: Sequence[int]) -> Actions:
    """float64, little-endian. Raises InvalidInput where the size is another or a number is not finite."""
    expected = 8 * int(np.prod(shape))
    if len(payload) != expected:
        raise InvalidInput(
            f"Actions of {len(payload)} bytes were given; shape {tuple(shape)} takes {expected}."
        )
    actions = np.frombuffer(payload, dtype="<f8").reshape(shape)
    if not np.isfinite(actions).all():
        raise InvalidInput("Actions with NaN or infinity were given; every number must be finite.")
    return actions
