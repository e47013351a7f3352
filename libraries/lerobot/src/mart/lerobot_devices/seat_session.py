"""Hold a seat of a room in another program's turns: it looks when it likes, and says one action at a time."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mart.lerobot_devices.features import ACTION_NAMES, action_numbers, observation_floats, observation_names
from mart.lerobot_devices.room_subscription import RoomSubscription
from mart.operators import Operator, OperatorKind, SeatView, ToolTarget, drive_seats, target_from_action
from mart.protocol import clock
from mart.protocol.errors import InvalidInput, MartError, Unavailable
from mart.protocol.messages import pose_from_message
from mart.render import Image, Renderer, load_model

HOLD_AFTER_S = 0.5  # without an action the clutch is let go
_SEATED_WITHIN_S = 20.0
_LEAVE_S = 10.0


@dataclass(frozen=True)
class SeatChoice:
    """Say which seat, under which name and as what, and which pictures are drawn.

    kind: policy, or human where a person leads. router: where the platform's router listens; None: MART_ROUTER, or this
    machine. viewpoints: names of the task's viewpoints.
    """

    room: str = "room-1"
    arm: str = "arm0"
    name: str = "lerobot"
    kind: str = OperatorKind.POLICY
    router: str | None = None
    viewpoints: Sequence[str] = ()
    width_px: int = 320
    height_px: int = 240


class LatestTarget(Operator):
    """Say again and again what was said last; once that is old, let the clutch go, and the arm holds."""

    def __init__(self) -> None:
        self.began = threading.Event()
        self._lock = threading.Lock()
        self._target: ToolTarget | None = None
        self._said_s = 0.0

    def say(self, target: ToolTarget) -> None:
        """Take what is wanted from now on."""
        with self._lock:
            self._target, self._said_s = target, clock.monotonic_s()

    def begin(self, episode: int) -> None:
        """Forget what was wanted in a world that is gone; see `Operator.begin`."""
        with self._lock:
            self._target = None

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return the newest target, at once: nobody waits for the other program; see `Operator.act`."""
        with self._lock:
            target, age_s = self._target, clock.monotonic_s() - self._said_s
        self.began.set()
        ((arm, measured),) = view.poses_tool_in_base.items()
        if target is None or age_s > HOLD_AFTER_S:
            return {arm: ToolTarget(measured, target.gripper if target else 0.0, engaged=False)}
        return {arm: target}


class SeatSession:
    """Take a seat with `open`, and leave it with `close`. Every method raises a MartError, a sentence, where it cannot.

    Used by one thread: pictures are drawn on it.
    """

    def __init__(self, choice: SeatChoice) -> None:
        if choice.kind not in (OperatorKind.POLICY, OperatorKind.HUMAN):
            raise InvalidInput(f"The seat was to be driven as {choice.kind!r}; it may be policy or human.")
        self.choice = choice
        self._feed: RoomSubscription | None = None
        self._renderers: dict[str, Renderer] = {}
        self._operator = LatestTarget()
        self._stop, self._left = threading.Event(), threading.Event()
        self._failure: MartError | None = None
        self._driving: threading.Thread | None = None

    @property
    def is_open(self) -> bool:
        """Whether the seat was taken and not left."""
        return self._driving is not None

    def observed_names(self) -> tuple[str, ...]:
        """Return the names of the numbers of an observation; the room is asked for its task."""
        return observation_names(self._room().task, self.choice.arm)

    def open(self) -> None:
        """Take the seat, and wait until it is driven. Raises Conflict where somebody sits there."""
        self._room()
        self._stop.clear()
        self._left.clear()
        self._failure, self._operator = None, LatestTarget()
        self._driving = threading.Thread(target=self._drive, name="mart seat", daemon=True)
        self._driving.start()
        until_s = clock.monotonic_s() + _SEATED_WITHIN_S
        while not self._operator.began.wait(0.05):
            if self._left.is_set() or clock.monotonic_s() > until_s:
                failure = self._why_not_seated()
                self.close()
                raise failure

    def observe(self) -> tuple[dict[str, float], dict[str, Image]]:
        """Return what the seat is shown now, numbers and pictures of one tick."""
        feed = self._held()
        state = feed.state()
        shown = {one.name: list(one.value) for one in state.observations}
        try:
            numbers = observation_floats(feed.task, self.choice.arm, shown)
        except (KeyError, ValueError) as error:
            raise Unavailable(f"{feed.room} has shown a state that lacks something: {error}.") from error
        return numbers, {
            name: self._picture(name, state.integration_state) for name in self.choice.viewpoints
        }

    def send(self, action: Mapping[str, object]) -> dict[str, float]:
        """Send an action, 7 numbers by `ACTION_NAMES`, and return it as it was sent: each within [-1, 1]."""
        numbers = action_numbers(action)
        feed = self._held()
        measured = pose_from_message(feed.arm_state(feed.state()).tool_in_base)
        self._operator.say(
            ToolTarget(*target_from_action(measured, numbers, feed.task.arm(self.choice.arm).kind.limits))
        )
        return dict(zip(ACTION_NAMES, numbers.tolist(), strict=True))

    def close(self) -> None:
        """Leave the seat."""
        self._stop.set()
        if self._driving is not None:
            self._driving.join(_LEAVE_S)
            self._driving = None
        for renderer in self._renderers.values():
            renderer.close()
        self._renderers = {}
        if self._feed is not None:
            self._feed.close()
            self._feed = None

    def _why_not_seated(self) -> MartError:
        if self._failure is not None:
            return self._failure
        return Unavailable(
            f"{self.choice.room} gave the seat and then stood still for {_SEATED_WITHIN_S:g} s: is it stopped, or does "
            "it wait for somebody?"
        )

    def _room(self) -> RoomSubscription:
        if self._feed is None:
            self._feed = RoomSubscription(self.choice.room, self.choice.arm, self.choice.router)
        return self._feed

    def _held(self) -> RoomSubscription:
        if self._failure is not None:
            raise self._failure
        if self._driving is None or self._left.is_set():
            raise Unavailable(f"No seat of {self.choice.room} is held: connect first.")
        return self._room()

    def _drive(self) -> None:
        try:
            drive_seats(
                self._operator,
                self.choice.room,
                [self.choice.arm],
                name=self.choice.name,
                kind=OperatorKind(self.choice.kind),
                router=self.choice.router,
                stop=self._stop,
            )
        except MartError as error:
            self._failure = error
        finally:
            self._left.set()

    def _picture(self, viewpoint: str, integration_state: bytes) -> Image:
        renderer = self._renderers.get(viewpoint)
        if renderer is None:
            message = self._room().model
            model = load_model(
                message.mjb,
                sha256=message.sha256,
                mujoco_version=message.mujoco_version,
                source=self.choice.room,
            )
            renderer = Renderer(model, viewpoint, self.choice.width_px, self.choice.height_px)
            self._renderers[viewpoint] = renderer
        return renderer.draw(integration_state)
