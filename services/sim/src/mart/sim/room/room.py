"""Put seats, barrier, episode and world together into one room."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    EPISODE_PHASE_PRACTICE,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    EpisodeRequest,
    Event,
    RoomReply,
    RoomStatus,
    Seat,
    SeatRequest,
    State,
    error_message,
    is_good,
)
from mart.sim.room import room_messages
from mart.sim.room.barrier import Barrier, Decision, TickInputs
from mart.sim.room.command_intake import CommandIntake
from mart.sim.room.command_validation import CommandRejection
from mart.sim.room.driven_arms import DrivenArms
from mart.sim.room.emergency_stop import StopLatch
from mart.sim.room.episode_state_machine import (
    BeginEpisode,
    Effect,
    EndEpisode,
    EpisodeStateMachine,
    ResetWorld,
    Terms,
)
from mart.sim.room.host_words import hear_host
from mart.sim.room.recording_rules import RecordingRules
from mart.sim.room.recording_watch import RecordingWatch
from mart.sim.room.repeats import Repeats
from mart.sim.room.room_cameras import RoomCameras
from mart.sim.room.room_publisher import RoomPublisher
from mart.sim.room.saved_room import SavedRoom, SavedStop
from mart.sim.room.seats import SeatHolder, SeatTable
from mart.sim.room.ticker import Ticker
from mart.sim.world import Diverged, World


class Room:
    """Run one room; used by one thread at a time, which says what time it is (`now_s`, monotonic seconds).

    What it says goes to `publisher`, what must survive a crash to `keep`, which may raise OSError. `explain`: what
    became of a world that left its bounds. `before`: the room that goes on in this one.
    """

    def __init__(
        self,
        name: str,
        world: World,
        record: SavedRoom,
        publisher: RoomPublisher,
        keep: Callable[[SavedRoom], None],
        *,
        now_s: float,
        pace: float = 1.0,
        before: RoomStatus = RoomStatus(),  # noqa: B008 - never changed
        terms: Terms = Terms(),  # noqa: B008 - frozen
        explain: Callable[[Diverged], str] = str,
        drivers: DrivenArms | None = None,
    ) -> None:
        self._name, self._world, self._record = name, world, record
        self._publisher, self._keep, self._explain = publisher, keep, explain
        self._boot_ns = clock.wall_ns()
        self.drivers = drivers or DrivenArms(name, {}, world.control_hz, send=lambda _: None)
        self.drivers.begin(self._boot_ns, now_s)
        self._seats = SeatTable(world.arms)
        self._seats.restore(record.holders())
        self._barrier = Barrier(world.arms, world.control_period_s / pace, now_s)
        for seat in self._seats:
            self._barrier.seat(seat.arm, seat.operator, seat.epoch, now_s, restored=True)
        self._terms, self._time_limit_s = terms, terms.time_limit_s or world.task.time_limit_s
        horizon_ticks = round(self._time_limit_s / world.control_period_s)
        self._episode = EpisodeStateMachine(record.seed, horizon_ticks, record.episodes)
        self._ticker = Ticker(name, world, self._boot_ns, now_s, before.tick)
        self._intake = CommandIntake(self._barrier, self._ticker, self._seats, self.tell, world.control_hz)
        self._last_ended = before.last_ended if before.HasField("last_ended") else None
        self.recording_watch, self.cameras = RecordingWatch(self._boot_ns), RoomCameras(terms.cameras, now_s)
        self._told: tuple[object, ...] = (BARRIER_PHASE_RUNNING,)  # barrier phase and arms waited for
        self._decision = Decision(BARRIER_PHASE_RUNNING, (), (), None, now_s)
        self._repeats = Repeats(publisher, now_s)
        self._stop = StopLatch(
            self._barrier, self._seats, record.stop, self._stop_changed, now_s, paced=not terms.lockstep
        )
        self._remember(record)
        self._do([ResetWorld(self._episode.seed)], now_s)
        self._stop.hear_drivers(self.drivers.troubles(now_s), now_s)

    @property
    def rejected(self) -> Counter[CommandRejection]:
        """Count the commands that were not used since the room opened, by reason."""
        return self._barrier.rejected

    @property
    def unsaved(self) -> tuple[int, ...]:
        """Return the newest episodes that have ended and of whose file nobody has told."""
        return self._record.uncounted()

    @property
    def in_practice(self) -> bool:
        """Whether no episode is under way."""
        return self._episode.phase == EPISODE_PHASE_PRACTICE

    def hear(self, payload: bytes, arm: str, at_s: float, at_wall_ns: int) -> None:
        """Take a command that came on the key of `arm`, or count why it cannot be used."""
        if (taken := self._intake.take(payload, arm, at_s, at_wall_ns)) and taken.emergency_stop:
            self._stop.heard(taken.arm)

    def answer_seat(self, request: SeatRequest, now_s: float) -> RoomReply:
        """Do what a seat request asks; the reply holds the status, and the seat or an error."""
        try:
            before = list(self._seats)
            self._rules.require_may_come(request, self._seats, practising=self.in_practice)
            seat = self._seats.answer(request)
            if seat not in before:
                self._seat_changed(seat, now_s)
                if request.HasField("free"):
                    self.tell(room_messages.freed(request.free))
            elif request.HasField("claim"):  # they may have passed the course meanwhile
                self._remember(self._record.with_seats(self._seats))
        except MartError as error:
            return RoomReply(error=error_message(error), status=self.status(now_s))
        return RoomReply(status=self.status(now_s), seat=self._seat_message(seat, now_s))

    def answer_episode(self, request: EpisodeRequest, now_s: float) -> RoomReply:
        """Do what an episode request asks; the reply holds the status, and an error where it was refused."""
        try:
            match request.WhichOneof("what"):
                case "stop":
                    self._stop.press(request.stop, now_s)
                case "go_on":
                    self._stop.let_go(request.go_on, self.drivers.troubles(now_s))
                case "set_plan" | "require_course":
                    record, said = hear_host(request, self._record, practice=self._terms.practice)
                    self.tell(said)
                    self._remember(record)
                case _:
                    self._rules.require_may_begin(request, self._seats)
                    self._do(self._episode.answer(request, self._seats, now_s), now_s)
        except MartError as error:
            return RoomReply(error=error_message(error), status=self.status(now_s))
        self._repeats.status_soon()
        return RoomReply(status=self.status(now_s))

    def episode_saved(self, saved: Event.EpisodeSaved) -> None:
        """Count an episode that the recorder has saved, once, however often it is told."""
        if (counted := self._record.with_saved(saved.number, is_good(saved))) is not self._record:
            self._remember(counted)

    def advance(self, now_s: float) -> float:
        """Do what is due; return the time at which to call again if nothing arrives before."""
        self._stop.hear_drivers(self.drivers.troubles(now_s), now_s)
        decision = self._barrier.advance(now_s, self._episode.world_runs, awaits_away=not self.in_practice)
        if decision.inputs is not None:
            self._fire(decision.inputs, now_s)
        self._decision = decision
        drivers_s = self.drivers.repeat(self._barrier.stopped, now_s)
        self._tell_barrier(decision)
        for arm in decision.silent:
            self._give_up(arm, now_s)
        effects = self._episode.advance(decision.phase == BARRIER_PHASE_RUNNING, now_s)
        self._do(effects, now_s)
        self._repeat(now_s)
        next_s = min(decision.next_s, self._episode.next_s(now_s), self._repeats.next_s, drivers_s)
        return now_s if effects or decision.silent else next_s

    def status(self, now_s: float) -> RoomStatus:
        """Return how the room stands at `now_s`."""
        progress = self._ticker.progress
        return RoomStatus(
            room=self._name,
            task=self._world.task.name,
            control_hz=self._world.control_hz,
            tick=self._ticker.tick,
            real_time_factor=self._ticker.real_time_factor(now_s) if self._episode.world_runs else 1.0,
            barrier=self._decision.phase,
            waiting_for=room_messages.waiting(self._decision.waiting_for),
            seats=[self._seat_message(seat, now_s) for seat in self._seats],
            episode=room_messages.episode(self._episode, self._world.control_period_s, now_s),
            progress=room_messages.progress(progress) if progress is not None else None,
            to_do=room_messages.to_do(self._world, progress) if progress is not None else None,
            wall_ns=clock.wall_ns(),
            boot=self._boot_ns,
            rejected_commands=self.rejected.total(),
            stop=self._stop.message(),
            last_ended=self._last_ended,
            unrecorded=self.recording_watch.objection(now_s),
            practice=self._terms.practice,
            arm_kinds=self._world.task.arm_kinds,
            driven_arms=self.drivers.messages(now_s),
            cameras=self.cameras.messages(now_s),
            **room_messages.counts(self._record),
        )

    def _fire(self, inputs: TickInputs, now_s: float) -> None:
        self.drivers.begin_tick(self._ticker.tick + 1, inputs.commands, self._seats, now_s)
        try:
            state = self._ticker.advance(inputs, self._seats, self._episode, now_s)
        except Diverged as error:
            self.tell(room_messages.notice("warning", self._explain(error)))
            self._do(self._episode.diverged(now_s), now_s)
            return
        self._tell_state(state, now_s)
        self._do(self._episode.ticked(state.progress.success, state.progress.failed or None, now_s), now_s)

    def _do(self, effects: Sequence[Effect], now_s: float) -> None:
        for effect in effects:
            match effect:
                case ResetWorld():
                    fresh = self._ticker.reset(effect.seed, self._seats, self._episode, now_s)
                    self._tell_state(fresh, now_s)
                    self._barrier.restart(now_s)
                    self._intake.world_reset()
                    self.tell(Event(world_reset=Event.WorldReset(seed=effect.seed)))
                case BeginEpisode():
                    self._start(effect, now_s)
                case EndEpisode():
                    ended = room_messages.episode_ended(effect, self._ticker.tick, self._ticker.progress)
                    self._last_ended = ended
                    self.tell(Event(episode_ended=ended))
            self._repeats.status_soon()

    def _start(self, effect: BeginEpisode, now_s: float) -> None:
        self._remember(self._record.with_changes(episodes=effect.number))
        seats = [self._seat_message(seat, now_s) for seat in self._seats]
        begun = room_messages.episode_started(effect, seats, self._world, self._terms, self._time_limit_s)
        begun.episode_started.measured_arms.extend(self.drivers.arms)
        self.tell(begun)
        self._tell_state(self._ticker.standing(self._seats, self._episode, now_s), now_s)
        self._barrier.restart(now_s)

    def _give_up(self, arm: str, now_s: float) -> None:
        news = room_messages.gave_up(self._seats[arm])
        self._seat_changed(self._seats.free(arm), now_s)
        self.tell(news)

    def _seat_changed(self, seat: SeatHolder, now_s: float) -> None:
        self._barrier.seat(seat.arm, seat.operator, seat.epoch, now_s)
        self._remember(self._record.with_seats(self._seats))
        self.tell(Event(seat_changed=self._seat_message(seat, now_s)))
        self._do(self._episode.seats_changed(self._seats, now_s), now_s)
        if seat.operator == OPERATOR_HUMAN and self.in_practice and self._ticker.keeps_score:
            self._do(self._episode.practise_anew(), now_s)  # a score is of who drove from the beginning
        self._repeats.status_soon()

    def _stop_changed(self, pressed: SavedStop | None, event: Event) -> None:
        self._remember(self._record.with_changes(stop=pressed))
        self.tell(event)
        self._repeats.status_soon()

    def _tell_barrier(self, decision: Decision) -> None:
        if decision.stands:
            self._episode.interrupt()
        holds = (decision.phase, *(arm for arm, _ in decision.waiting_for))
        if holds != self._told:
            self._told = holds
            self.tell(room_messages.barrier_changed(decision.phase, decision.waiting_for))
            self._repeats.status_soon()

    def _tell_state(self, state: State, now_s: float) -> None:
        self.drivers.mark(state, now_s)
        self._repeats.state(state, now_s)
        self.recording_watch.told(0 if self._terms.lockstep else state.episode, state.tick, now_s)

    def tell(self, event: Event) -> None:
        """Tell everybody what has just happened."""
        event.wall_ns, event.room, event.tick = clock.wall_ns(), self._name, self._ticker.tick
        self._publisher.event(event)

    def _repeat(self, now_s: float) -> None:
        if (news := self.recording_watch.news(now_s)) is not None:
            self.tell(room_messages.notice(*news))
            self._repeats.status_soon()
        self._repeats.repeat(self.status, now_s)

    def _seat_message(self, seat: SeatHolder, now_s: float) -> Seat:
        newest = self._barrier.newest(seat.arm) if seat.operator != OPERATOR_HOLD else None
        ready, kept_s = self._episode.is_ready(seat.arm), self._barrier.kept_s(seat.arm, now_s)
        return room_messages.seat(seat, ready, newest, f"{self._boot_ns:x}", kept_s)

    def _remember(self, record: SavedRoom) -> None:
        """Keep the record over a restart; a disk that is full must not stop the world."""
        self._record = record
        self._rules = RecordingRules(self._terms.practice, record.course_required)
        try:
            self._keep(record)
        except OSError as error:
            text = f"A restart would forget this change of the room: {error}."
            self.tell(room_messages.notice("error", text))
