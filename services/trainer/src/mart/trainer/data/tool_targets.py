"""Actions of a chunk as poses from where the tool was when the chunk began, and back.

An action is a step from where the tool is measured to be in its tick: of a chunk that was predicted whole, each step
begins wherever the steps before have led. As absolute targets, what was commanded is said from one place:

    position   p_k = (x_k + s a_k - x_0) / (4 s)                x: the tool's position, s: the largest step (m)
    rotation   r_k = log(exp(w b_k) q_k q_0^-1) / (4 w)         q: its quaternion, w: the largest turn (rad)
    and back   a_k = (x_0 + 4 s p_k - x_k) / s,   b_k = log(exp(4 w r_k) q_0 q_k^-1) / w,   within [-1, 1]

x_k and q_k are measured in tick k, both times: what the tool lags behind is asked for again. Both lie within [-1, 1]
where a chunk goes no farther than four steps from where it began; the gripper's number is the same in both.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task
from mart.trainer.data.layout import ObservationLayout

_REACH = 4.0  # steps
_SMALL_RAD = 1e-6


class ToolTargets:
    """Turns actions into absolute targets and back, for all arms of a task."""

    def __init__(self, task: str, layout: ObservationLayout, arm_kinds: Sequence[str] = ()) -> None:
        """Look up where each arm's tool is among the observations, and its largest steps.

        Raises InvalidInput where an arm's tool is not observed, NotFound for an unknown task or kind.
        """
        limits = [arm.kind.limits for arm in get_task(task, len(layout.arms), arm_kinds).arms]
        steps = [[one.step_m] * 3 + [one.step_rad] * 3 for one in limits]
        self._steps = torch.tensor(steps)
        self._columns = torch.tensor([_columns(layout, arm) for arm in layout.arms])

    def poses(self, obs: Tensor) -> Tensor:
        """Return the tools' positions and quaternions: [..., D], not normalised → [..., arms, 7]."""
        return obs[..., self._columns.to(obs.device)]

    def absolute(self, actions: Tensor, now: Tensor, start: Tensor) -> Tensor:
        """Return actions, [..., arms, 7], as targets seen from `start`. now: the tools' poses in each one's tick."""
        steps = actions[..., :6] * self._steps.to(actions.device)
        position = now[..., :3] + steps[..., :3] - start[..., :3]
        goal = _multiply(_exp(steps[..., 3:]), now[..., 3:])
        turn = _log(_multiply(goal, _conjugate(start[..., 3:])))
        return self._joined(position, turn, actions, _REACH)

    def actions(self, targets: Tensor, now: Tensor, start: Tensor) -> Tensor:
        """Return the actions of this tick that go towards `targets`, the inverse of `absolute` within [-1, 1]."""
        from_start = targets[..., :6] * self._steps.to(targets.device) * _REACH
        position = start[..., :3] + from_start[..., :3] - now[..., :3]
        goal = _multiply(_exp(from_start[..., 3:]), start[..., 3:])
        turn = _log(_multiply(goal, _conjugate(now[..., 3:])))
        return self._joined(position, turn, targets, 1.0).clamp(-1, 1)

    def _joined(self, position: Tensor, turn: Tensor, other: Tensor, reach: float) -> Tensor:
        numbers = torch.cat((position, turn), -1) / (self._steps.to(position.device) * reach)
        return torch.cat((numbers, other[..., 6:]), -1)


def _columns(layout: ObservationLayout, arm: str) -> list[int]:
    names = [f"{arm}/tool_position_in_base", f"{arm}/tool_quaternion_in_base"]
    missing = [name for name in names if name not in layout.names]
    if missing:
        raise InvalidInput(f"Absolute targets need the observation {missing[0]}; use action_target=delta.")
    groups = layout.groups()
    found = [np.flatnonzero(groups == layout.names.index(name)) for name in names]
    return [int(column) for columns in found for column in columns]


def _multiply(a: Tensor, b: Tensor) -> Tensor:
    """Return the Hamilton product of quaternions wxyz: [..., 4]."""
    (aw, av), (bw, bv) = (q.split((1, 3), -1) for q in (a, b))
    vector = aw * bv + bw * av + torch.linalg.cross(av, bv)
    return torch.cat((aw * bw - (av * bv).sum(-1, keepdim=True), vector), -1)


def _conjugate(q: Tensor) -> Tensor:
    return torch.cat((q[..., :1], -q[..., 1:]), -1)


def _exp(turn: Tensor) -> Tensor:
    """Return the quaternions of rotation vectors: [..., 3] in rad → [..., 4]."""
    half = turn.norm(dim=-1, keepdim=True) / 2
    return torch.cat((torch.cos(half), turn / 2 * torch.sinc(half / torch.pi)), -1)


def _log(q: Tensor) -> Tensor:
    """Return the rotation vectors of quaternions, angles in [0, pi]: [..., 4] → [..., 3] in rad."""
    q = torch.where(q[..., :1] < 0, -q, q)
    sine = q[..., 1:].norm(dim=-1, keepdim=True)
    angle = 2 * torch.atan2(sine, q[..., :1])
    return q[..., 1:] * torch.where(sine > _SMALL_RAD, angle / sine.clamp(min=_SMALL_RAD), 2.0)
