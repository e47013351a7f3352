"""Step worlds by requests, as fast as the machine allows: for training, evaluation and re-simulation.

The barrier's rule holds here too: a request carries an action for every arm of every world, so each world advances
exactly when all its arms have been told what to do. The worlds are those of the rooms.
"""

from __future__ import annotations

import math
import os
import secrets
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mart.protocol.batch_state import ACTION_SIZE, Array, Flags, check_actions, pack
from mart.protocol.errors import Conflict, InvalidInput, NotFound, Unavailable
from mart.protocol.messages import RolloutReply, RolloutRequest
from mart.sim.rollout.compiled_worlds import CompiledWorlds, WorldSpec
from mart.sim.rollout.resimulation import NativeProcess, Resimulator
from mart.sim.world import Diverged, WorldBatch
from mart.sim.world.model_message import model_message

MAX_SESSIONS = 8
# Of all sessions. By calculation 150 MB with three arms: states, kept six times, and poses.
MAX_WORLDS = 4096
IDLE_S = 600.0


@dataclass
class _Session:
    worlds: WorldBatch
    arms: int
    integration_states: bool
    used_s: float
    steps: int = 0

    def reply(self, name: str) -> RolloutReply:
        standing = self.worlds.standing(integration_states=self.integration_states)
        return RolloutReply(session=name, worlds=pack(standing))


class RolloutServer:
    """Answer rollout requests with worlds of this process; `threads` step a batch, all cores by default.

    explain: says in words why a world has failed whose physics left its bounds. native: see `Resimulator`.
    """

    def __init__(
        self,
        threads: int | None = None,
        explain: Callable[[Diverged], str] = str,
        native: NativeProcess | None = None,
    ) -> None:
        self._explain = explain
        self._threads = threads or os.cpu_count() or 1
        self._boot = secrets.token_hex(4)  # tells a session of an earlier run from one that was closed
        self._opened = 0
        self._worlds = CompiledWorlds()
        self._resimulator = Resimulator(self._worlds, native)
        self._sessions: dict[str, _Session] = {}

    def answer(self, request: RolloutRequest, now_s: float) -> RolloutReply:
        """Do what a request asks at `now_s` (monotonic). Raises errors of the tree."""
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
                return self._resimulator.resimulate(request.resimulate)
            case "compare_ticks":
                return self._resimulator.compare(request.compare_ticks)
            case "describe":
                return self._describe(request.describe)
        raise InvalidInput(
            "An empty rollout request was given; ask for reset, step, close, resimulate, compare_ticks or describe."
        )

    def _reset(self, reset: RolloutRequest.Reset, now_s: float) -> RolloutReply:
        self._require_room(len(reset.seeds))
        world = self._worlds.get(_spec(reset))
        worlds = WorldBatch(world, len(reset.seeds), self._threads, self._explain)
        worlds.reset(reset.seeds)
        self._opened += 1
        name = f"{self._boot}-{self._opened}"
        session = _Session(worlds, len(world.arms), reset.integration_states, now_s)
        self._sessions[name] = session
        return session.reply(name)

    def _step(self, step: RolloutRequest.Step, now_s: float) -> RolloutReply:
        session = self._session(step.session)
        session.used_s = now_s
        if step.number and step.number == session.steps:
            return session.reply(step.session)
        if step.number not in (0, session.steps + 1):
            raise Conflict(f"Step {step.number} was asked for after {session.steps}; steps come one by one.")
        count = len(session.worlds)
        actions = _actions(step.actions, (count, session.arms, ACTION_SIZE))
        check_actions(actions)
        session.worlds.step(actions, _running(step.running, count))
        session.steps += 1
        return session.reply(step.session)

    def _describe(self, request: RolloutRequest.Describe) -> RolloutReply:
        world = self._worlds.get(_spec(request))
        return RolloutReply(model=model_message(world))

    def _require_room(self, worlds: int) -> None:
        if not 1 <= worlds <= MAX_WORLDS:
            raise InvalidInput(
                f"{worlds} seeds were given; give 1 to {MAX_WORLDS}, one for each world, or use more replicas."
            )
        if len(self._sessions) >= MAX_SESSIONS:
            raise Unavailable(
                f"{MAX_SESSIONS} sessions are open already; close one, or wait {IDLE_S:g} s of idleness."
            )
        held = sum(len(session.worlds) for session in self._sessions.values())
        if held + worlds > MAX_WORLDS:
            raise Unavailable(
                f"{worlds} worlds were asked for, but {held} of {MAX_WORLDS} are held already; close a session, "
                "or use more replicas."
            )

    def _session(self, name: str) -> _Session:
        if name in self._sessions:
            return self._sessions[name]
        why = f"it was closed, or idle for {IDLE_S:g} s"
        if not name.startswith(self._boot):
            why = "it is not of this run of the replica, which has been restarted since"
        raise NotFound(f"There is no session {name!r}: {why}; reset to get one.")

    def _forget_idle(self, now_s: float) -> None:
        idle = [name for name, session in self._sessions.items() if now_s - session.used_s > IDLE_S]
        for name in idle:
            del self._sessions[name]


def _spec(asked: RolloutRequest.Reset | RolloutRequest.Describe) -> WorldSpec:
    return WorldSpec(asked.task, asked.control_hz, asked.arms or None, tuple(asked.arm_kinds))


def _actions(payload: bytes, shape: tuple[int, ...]) -> Array:
    """Read float64, little-endian, of this shape; raises InvalidInput where the size is another."""
    expected = 8 * math.prod(shape)
    if len(payload) != expected:
        raise InvalidInput(f"Actions of {len(payload)} bytes were given; shape {shape} takes {expected}.")
    return np.frombuffer(payload, dtype="<f8").reshape(shape)


def _running(payload: bytes, worlds: int) -> Flags:
    """Read one flag (uint8) a world; no bytes mean that all run."""
    if len(payload) not in (0, worlds):
        raise InvalidInput(f"{len(payload)} flags were given; give one for each of {worlds} worlds, or none.")
    return np.frombuffer(payload, np.uint8).astype(bool) if payload else np.ones(worlds, bool)
