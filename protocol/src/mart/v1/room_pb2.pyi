from mart.v1 import command_pb2 as _command_pb2
from mart.v1 import state_pb2 as _state_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class BarrierPhase(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    BARRIER_PHASE_UNSPECIFIED: _ClassVar[BarrierPhase]
    BARRIER_PHASE_RUNNING: _ClassVar[BarrierPhase]
    BARRIER_PHASE_STALLED: _ClassVar[BarrierPhase]
    BARRIER_PHASE_PAUSED: _ClassVar[BarrierPhase]
    BARRIER_PHASE_STOPPED: _ClassVar[BarrierPhase]

class EpisodePhase(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    EPISODE_PHASE_UNSPECIFIED: _ClassVar[EpisodePhase]
    EPISODE_PHASE_PRACTICE: _ClassVar[EpisodePhase]
    EPISODE_PHASE_COUNTDOWN: _ClassVar[EpisodePhase]
    EPISODE_PHASE_RECORDING: _ClassVar[EpisodePhase]
    EPISODE_PHASE_ENDED: _ClassVar[EpisodePhase]

class Outcome(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    OUTCOME_UNSPECIFIED: _ClassVar[Outcome]
    OUTCOME_SUCCESS: _ClassVar[Outcome]
    OUTCOME_FAILURE: _ClassVar[Outcome]
    OUTCOME_DISCARDED: _ClassVar[Outcome]

class EndedBy(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    ENDED_BY_UNSPECIFIED: _ClassVar[EndedBy]
    ENDED_BY_TASK: _ClassVar[EndedBy]
    ENDED_BY_TIME: _ClassVar[EndedBy]
    ENDED_BY_OPERATOR: _ClassVar[EndedBy]
    ENDED_BY_ABSENCE: _ClassVar[EndedBy]
    ENDED_BY_ROOM: _ClassVar[EndedBy]

class Cue(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    CUE_UNSPECIFIED: _ClassVar[Cue]
    CUE_HAVE_IT: _ClassVar[Cue]
    CUE_GO: _ClassVar[Cue]
    CUE_WAIT: _ClassVar[Cue]
    CUE_SLOWER: _ClassVar[Cue]
    CUE_THANKS: _ClassVar[Cue]
    CUE_LET_GO: _ClassVar[Cue]
    CUE_COME_CLOSER: _ClassVar[Cue]
BARRIER_PHASE_UNSPECIFIED: BarrierPhase
BARRIER_PHASE_RUNNING: BarrierPhase
BARRIER_PHASE_STALLED: BarrierPhase
BARRIER_PHASE_PAUSED: BarrierPhase
BARRIER_PHASE_STOPPED: BarrierPhase
EPISODE_PHASE_UNSPECIFIED: EpisodePhase
EPISODE_PHASE_PRACTICE: EpisodePhase
EPISODE_PHASE_COUNTDOWN: EpisodePhase
EPISODE_PHASE_RECORDING: EpisodePhase
EPISODE_PHASE_ENDED: EpisodePhase
OUTCOME_UNSPECIFIED: Outcome
OUTCOME_SUCCESS: Outcome
OUTCOME_FAILURE: Outcome
OUTCOME_DISCARDED: Outcome
ENDED_BY_UNSPECIFIED: EndedBy
ENDED_BY_TASK: EndedBy
ENDED_BY_TIME: EndedBy
ENDED_BY_OPERATOR: EndedBy
ENDED_BY_ABSENCE: EndedBy
ENDED_BY_ROOM: EndedBy
CUE_UNSPECIFIED: Cue
CUE_HAVE_IT: Cue
CUE_GO: Cue
CUE_WAIT: Cue
CUE_SLOWER: Cue
CUE_THANKS: Cue
CUE_LET_GO: Cue
CUE_COME_CLOSER: Cue

class Seat(_message.Message):
    __slots__ = ("arm", "operator", "epoch", "holder_id", "name", "ready", "engaged", "policy", "relieved", "relieved_operator", "holder_tag", "passed_course", "kept_s")
    ARM_FIELD_NUMBER: _ClassVar[int]
    OPERATOR_FIELD_NUMBER: _ClassVar[int]
    EPOCH_FIELD_NUMBER: _ClassVar[int]
    HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    READY_FIELD_NUMBER: _ClassVar[int]
    ENGAGED_FIELD_NUMBER: _ClassVar[int]
    POLICY_FIELD_NUMBER: _ClassVar[int]
    RELIEVED_FIELD_NUMBER: _ClassVar[int]
    RELIEVED_OPERATOR_FIELD_NUMBER: _ClassVar[int]
    HOLDER_TAG_FIELD_NUMBER: _ClassVar[int]
    PASSED_COURSE_FIELD_NUMBER: _ClassVar[int]
    KEPT_S_FIELD_NUMBER: _ClassVar[int]
    arm: str
    operator: _command_pb2.Operator
    epoch: int
    holder_id: str
    name: str
    ready: bool
    engaged: bool
    policy: str
    relieved: str
    relieved_operator: _command_pb2.Operator
    holder_tag: str
    passed_course: bool
    kept_s: float
    def __init__(self, arm: _Optional[str] = ..., operator: _Optional[_Union[_command_pb2.Operator, str]] = ..., epoch: _Optional[int] = ..., holder_id: _Optional[str] = ..., name: _Optional[str] = ..., ready: _Optional[bool] = ..., engaged: _Optional[bool] = ..., policy: _Optional[str] = ..., relieved: _Optional[str] = ..., relieved_operator: _Optional[_Union[_command_pb2.Operator, str]] = ..., holder_tag: _Optional[str] = ..., passed_course: _Optional[bool] = ..., kept_s: _Optional[float] = ...) -> None: ...

class Waiting(_message.Message):
    __slots__ = ("arm", "since_s")
    ARM_FIELD_NUMBER: _ClassVar[int]
    SINCE_S_FIELD_NUMBER: _ClassVar[int]
    arm: str
    since_s: float
    def __init__(self, arm: _Optional[str] = ..., since_s: _Optional[float] = ...) -> None: ...

class Episode(_message.Message):
    __slots__ = ("number", "phase", "remaining_s", "ticks", "elapsed_s", "outcome", "seed", "interrupted", "reason", "ended_by", "ended_by_name", "ended_by_arm")
    NUMBER_FIELD_NUMBER: _ClassVar[int]
    PHASE_FIELD_NUMBER: _ClassVar[int]
    REMAINING_S_FIELD_NUMBER: _ClassVar[int]
    TICKS_FIELD_NUMBER: _ClassVar[int]
    ELAPSED_S_FIELD_NUMBER: _ClassVar[int]
    OUTCOME_FIELD_NUMBER: _ClassVar[int]
    SEED_FIELD_NUMBER: _ClassVar[int]
    INTERRUPTED_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    ENDED_BY_FIELD_NUMBER: _ClassVar[int]
    ENDED_BY_NAME_FIELD_NUMBER: _ClassVar[int]
    ENDED_BY_ARM_FIELD_NUMBER: _ClassVar[int]
    number: int
    phase: EpisodePhase
    remaining_s: float
    ticks: int
    elapsed_s: float
    outcome: Outcome
    seed: int
    interrupted: bool
    reason: str
    ended_by: EndedBy
    ended_by_name: str
    ended_by_arm: str
    def __init__(self, number: _Optional[int] = ..., phase: _Optional[_Union[EpisodePhase, str]] = ..., remaining_s: _Optional[float] = ..., ticks: _Optional[int] = ..., elapsed_s: _Optional[float] = ..., outcome: _Optional[_Union[Outcome, str]] = ..., seed: _Optional[int] = ..., interrupted: _Optional[bool] = ..., reason: _Optional[str] = ..., ended_by: _Optional[_Union[EndedBy, str]] = ..., ended_by_name: _Optional[str] = ..., ended_by_arm: _Optional[str] = ...) -> None: ...

class Plan(_message.Message):
    __slots__ = ("episodes", "good")
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    GOOD_FIELD_NUMBER: _ClassVar[int]
    episodes: int
    good: int
    def __init__(self, episodes: _Optional[int] = ..., good: _Optional[int] = ...) -> None: ...

class DrivenArm(_message.Message):
    __slots__ = ("arm", "driver", "age_s", "fault")
    ARM_FIELD_NUMBER: _ClassVar[int]
    DRIVER_FIELD_NUMBER: _ClassVar[int]
    AGE_S_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    arm: str
    driver: str
    age_s: float
    fault: str
    def __init__(self, arm: _Optional[str] = ..., driver: _Optional[str] = ..., age_s: _Optional[float] = ..., fault: _Optional[str] = ...) -> None: ...

class EmergencyStop(_message.Message):
    __slots__ = ("arm", "name", "wall_ns", "by_host", "also_name", "fault")
    ARM_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    WALL_NS_FIELD_NUMBER: _ClassVar[int]
    BY_HOST_FIELD_NUMBER: _ClassVar[int]
    ALSO_NAME_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    arm: str
    name: str
    wall_ns: int
    by_host: bool
    also_name: str
    fault: str
    def __init__(self, arm: _Optional[str] = ..., name: _Optional[str] = ..., wall_ns: _Optional[int] = ..., by_host: _Optional[bool] = ..., also_name: _Optional[str] = ..., fault: _Optional[str] = ...) -> None: ...

class RoomCamera(_message.Message):
    __slots__ = ("camera", "dark", "dark_s", "width_px", "height_px", "frames_per_s")
    CAMERA_FIELD_NUMBER: _ClassVar[int]
    DARK_FIELD_NUMBER: _ClassVar[int]
    DARK_S_FIELD_NUMBER: _ClassVar[int]
    WIDTH_PX_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_PX_FIELD_NUMBER: _ClassVar[int]
    FRAMES_PER_S_FIELD_NUMBER: _ClassVar[int]
    camera: str
    dark: str
    dark_s: float
    width_px: int
    height_px: int
    frames_per_s: float
    def __init__(self, camera: _Optional[str] = ..., dark: _Optional[str] = ..., dark_s: _Optional[float] = ..., width_px: _Optional[int] = ..., height_px: _Optional[int] = ..., frames_per_s: _Optional[float] = ...) -> None: ...

class RoomStatus(_message.Message):
    __slots__ = ("room", "task", "control_hz", "tick", "real_time_factor", "barrier", "waiting_for", "seats", "episode", "progress", "episodes_saved", "episodes_good", "wall_ns", "boot", "rejected_commands", "plan", "stop", "last_ended", "unrecorded", "practice", "course_required", "arm_kinds", "driven_arms", "cameras", "to_do")
    class ToDoEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: str
        def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
    ROOM_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    TICK_FIELD_NUMBER: _ClassVar[int]
    REAL_TIME_FACTOR_FIELD_NUMBER: _ClassVar[int]
    BARRIER_FIELD_NUMBER: _ClassVar[int]
    WAITING_FOR_FIELD_NUMBER: _ClassVar[int]
    SEATS_FIELD_NUMBER: _ClassVar[int]
    EPISODE_FIELD_NUMBER: _ClassVar[int]
    PROGRESS_FIELD_NUMBER: _ClassVar[int]
    EPISODES_SAVED_FIELD_NUMBER: _ClassVar[int]
    EPISODES_GOOD_FIELD_NUMBER: _ClassVar[int]
    WALL_NS_FIELD_NUMBER: _ClassVar[int]
    BOOT_FIELD_NUMBER: _ClassVar[int]
    REJECTED_COMMANDS_FIELD_NUMBER: _ClassVar[int]
    PLAN_FIELD_NUMBER: _ClassVar[int]
    STOP_FIELD_NUMBER: _ClassVar[int]
    LAST_ENDED_FIELD_NUMBER: _ClassVar[int]
    UNRECORDED_FIELD_NUMBER: _ClassVar[int]
    PRACTICE_FIELD_NUMBER: _ClassVar[int]
    COURSE_REQUIRED_FIELD_NUMBER: _ClassVar[int]
    ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
    DRIVEN_ARMS_FIELD_NUMBER: _ClassVar[int]
    CAMERAS_FIELD_NUMBER: _ClassVar[int]
    TO_DO_FIELD_NUMBER: _ClassVar[int]
    room: str
    task: str
    control_hz: float
    tick: int
    real_time_factor: float
    barrier: BarrierPhase
    waiting_for: _containers.RepeatedCompositeFieldContainer[Waiting]
    seats: _containers.RepeatedCompositeFieldContainer[Seat]
    episode: Episode
    progress: _state_pb2.Progress
    episodes_saved: int
    episodes_good: int
    wall_ns: int
    boot: int
    rejected_commands: int
    plan: Plan
    stop: EmergencyStop
    last_ended: Event.EpisodeEnded
    unrecorded: str
    practice: bool
    course_required: bool
    arm_kinds: _containers.RepeatedScalarFieldContainer[str]
    driven_arms: _containers.RepeatedCompositeFieldContainer[DrivenArm]
    cameras: _containers.RepeatedCompositeFieldContainer[RoomCamera]
    to_do: _containers.ScalarMap[str, str]
    def __init__(self, room: _Optional[str] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., tick: _Optional[int] = ..., real_time_factor: _Optional[float] = ..., barrier: _Optional[_Union[BarrierPhase, str]] = ..., waiting_for: _Optional[_Iterable[_Union[Waiting, _Mapping]]] = ..., seats: _Optional[_Iterable[_Union[Seat, _Mapping]]] = ..., episode: _Optional[_Union[Episode, _Mapping]] = ..., progress: _Optional[_Union[_state_pb2.Progress, _Mapping]] = ..., episodes_saved: _Optional[int] = ..., episodes_good: _Optional[int] = ..., wall_ns: _Optional[int] = ..., boot: _Optional[int] = ..., rejected_commands: _Optional[int] = ..., plan: _Optional[_Union[Plan, _Mapping]] = ..., stop: _Optional[_Union[EmergencyStop, _Mapping]] = ..., last_ended: _Optional[_Union[Event.EpisodeEnded, _Mapping]] = ..., unrecorded: _Optional[str] = ..., practice: _Optional[bool] = ..., course_required: _Optional[bool] = ..., arm_kinds: _Optional[_Iterable[str]] = ..., driven_arms: _Optional[_Iterable[_Union[DrivenArm, _Mapping]]] = ..., cameras: _Optional[_Iterable[_Union[RoomCamera, _Mapping]]] = ..., to_do: _Optional[_Mapping[str, str]] = ...) -> None: ...

class SeatRequest(_message.Message):
    __slots__ = ("claim", "release", "assign", "hand_back", "free")
    class Claim(_message.Message):
        __slots__ = ("arm", "holder_id", "name", "operator", "passed_course")
        ARM_FIELD_NUMBER: _ClassVar[int]
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        OPERATOR_FIELD_NUMBER: _ClassVar[int]
        PASSED_COURSE_FIELD_NUMBER: _ClassVar[int]
        arm: str
        holder_id: str
        name: str
        operator: _command_pb2.Operator
        passed_course: bool
        def __init__(self, arm: _Optional[str] = ..., holder_id: _Optional[str] = ..., name: _Optional[str] = ..., operator: _Optional[_Union[_command_pb2.Operator, str]] = ..., passed_course: _Optional[bool] = ...) -> None: ...
    class Release(_message.Message):
        __slots__ = ("arm", "holder_id")
        ARM_FIELD_NUMBER: _ClassVar[int]
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        arm: str
        holder_id: str
        def __init__(self, arm: _Optional[str] = ..., holder_id: _Optional[str] = ...) -> None: ...
    class Assign(_message.Message):
        __slots__ = ("arm", "operator", "policy", "name")
        ARM_FIELD_NUMBER: _ClassVar[int]
        OPERATOR_FIELD_NUMBER: _ClassVar[int]
        POLICY_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        arm: str
        operator: _command_pb2.Operator
        policy: str
        name: str
        def __init__(self, arm: _Optional[str] = ..., operator: _Optional[_Union[_command_pb2.Operator, str]] = ..., policy: _Optional[str] = ..., name: _Optional[str] = ...) -> None: ...
    class HandBack(_message.Message):
        __slots__ = ("arm", "holder_id")
        ARM_FIELD_NUMBER: _ClassVar[int]
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        arm: str
        holder_id: str
        def __init__(self, arm: _Optional[str] = ..., holder_id: _Optional[str] = ...) -> None: ...
    class Free(_message.Message):
        __slots__ = ("arm", "name")
        ARM_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        arm: str
        name: str
        def __init__(self, arm: _Optional[str] = ..., name: _Optional[str] = ...) -> None: ...
    CLAIM_FIELD_NUMBER: _ClassVar[int]
    RELEASE_FIELD_NUMBER: _ClassVar[int]
    ASSIGN_FIELD_NUMBER: _ClassVar[int]
    HAND_BACK_FIELD_NUMBER: _ClassVar[int]
    FREE_FIELD_NUMBER: _ClassVar[int]
    claim: SeatRequest.Claim
    release: SeatRequest.Release
    assign: SeatRequest.Assign
    hand_back: SeatRequest.HandBack
    free: SeatRequest.Free
    def __init__(self, claim: _Optional[_Union[SeatRequest.Claim, _Mapping]] = ..., release: _Optional[_Union[SeatRequest.Release, _Mapping]] = ..., assign: _Optional[_Union[SeatRequest.Assign, _Mapping]] = ..., hand_back: _Optional[_Union[SeatRequest.HandBack, _Mapping]] = ..., free: _Optional[_Union[SeatRequest.Free, _Mapping]] = ...) -> None: ...

class EpisodeRequest(_message.Message):
    __slots__ = ("ready", "finish", "reset", "set_plan", "require_course", "stop", "go_on")
    class Ready(_message.Message):
        __slots__ = ("arm", "holder_id", "ready", "number")
        ARM_FIELD_NUMBER: _ClassVar[int]
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        READY_FIELD_NUMBER: _ClassVar[int]
        NUMBER_FIELD_NUMBER: _ClassVar[int]
        arm: str
        holder_id: str
        ready: bool
        number: int
        def __init__(self, arm: _Optional[str] = ..., holder_id: _Optional[str] = ..., ready: _Optional[bool] = ..., number: _Optional[int] = ...) -> None: ...
    class Finish(_message.Message):
        __slots__ = ("holder_id", "outcome", "host")
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        OUTCOME_FIELD_NUMBER: _ClassVar[int]
        HOST_FIELD_NUMBER: _ClassVar[int]
        holder_id: str
        outcome: Outcome
        host: str
        def __init__(self, holder_id: _Optional[str] = ..., outcome: _Optional[_Union[Outcome, str]] = ..., host: _Optional[str] = ...) -> None: ...
    class Reset(_message.Message):
        __slots__ = ("holder_id", "host")
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        HOST_FIELD_NUMBER: _ClassVar[int]
        holder_id: str
        host: str
        def __init__(self, holder_id: _Optional[str] = ..., host: _Optional[str] = ...) -> None: ...
    class Stop(_message.Message):
        __slots__ = ("holder_id", "name", "by_host")
        HOLDER_ID_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        BY_HOST_FIELD_NUMBER: _ClassVar[int]
        holder_id: str
        name: str
        by_host: bool
        def __init__(self, holder_id: _Optional[str] = ..., name: _Optional[str] = ..., by_host: _Optional[bool] = ...) -> None: ...
    class GoOn(_message.Message):
        __slots__ = ("name", "by_host")
        NAME_FIELD_NUMBER: _ClassVar[int]
        BY_HOST_FIELD_NUMBER: _ClassVar[int]
        name: str
        by_host: bool
        def __init__(self, name: _Optional[str] = ..., by_host: _Optional[bool] = ...) -> None: ...
    class SetPlan(_message.Message):
        __slots__ = ("episodes", "name")
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        episodes: int
        name: str
        def __init__(self, episodes: _Optional[int] = ..., name: _Optional[str] = ...) -> None: ...
    class RequireCourse(_message.Message):
        __slots__ = ("required", "name")
        REQUIRED_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        required: bool
        name: str
        def __init__(self, required: _Optional[bool] = ..., name: _Optional[str] = ...) -> None: ...
    READY_FIELD_NUMBER: _ClassVar[int]
    FINISH_FIELD_NUMBER: _ClassVar[int]
    RESET_FIELD_NUMBER: _ClassVar[int]
    SET_PLAN_FIELD_NUMBER: _ClassVar[int]
    REQUIRE_COURSE_FIELD_NUMBER: _ClassVar[int]
    STOP_FIELD_NUMBER: _ClassVar[int]
    GO_ON_FIELD_NUMBER: _ClassVar[int]
    ready: EpisodeRequest.Ready
    finish: EpisodeRequest.Finish
    reset: EpisodeRequest.Reset
    set_plan: EpisodeRequest.SetPlan
    require_course: EpisodeRequest.RequireCourse
    stop: EpisodeRequest.Stop
    go_on: EpisodeRequest.GoOn
    def __init__(self, ready: _Optional[_Union[EpisodeRequest.Ready, _Mapping]] = ..., finish: _Optional[_Union[EpisodeRequest.Finish, _Mapping]] = ..., reset: _Optional[_Union[EpisodeRequest.Reset, _Mapping]] = ..., set_plan: _Optional[_Union[EpisodeRequest.SetPlan, _Mapping]] = ..., require_course: _Optional[_Union[EpisodeRequest.RequireCourse, _Mapping]] = ..., stop: _Optional[_Union[EpisodeRequest.Stop, _Mapping]] = ..., go_on: _Optional[_Union[EpisodeRequest.GoOn, _Mapping]] = ...) -> None: ...

class RoomsRequest(_message.Message):
    __slots__ = ("open", "close")
    class Open(_message.Message):
        __slots__ = ("room", "task", "control_hz", "episodes", "arms", "practice", "course_required", "arm_kinds")
        class ArmKindsEntry(_message.Message):
            __slots__ = ("key", "value")
            KEY_FIELD_NUMBER: _ClassVar[int]
            VALUE_FIELD_NUMBER: _ClassVar[int]
            key: str
            value: str
            def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
        ROOM_FIELD_NUMBER: _ClassVar[int]
        TASK_FIELD_NUMBER: _ClassVar[int]
        CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        ARMS_FIELD_NUMBER: _ClassVar[int]
        PRACTICE_FIELD_NUMBER: _ClassVar[int]
        COURSE_REQUIRED_FIELD_NUMBER: _ClassVar[int]
        ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
        room: str
        task: str
        control_hz: float
        episodes: int
        arms: int
        practice: bool
        course_required: bool
        arm_kinds: _containers.ScalarMap[str, str]
        def __init__(self, room: _Optional[str] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., episodes: _Optional[int] = ..., arms: _Optional[int] = ..., practice: _Optional[bool] = ..., course_required: _Optional[bool] = ..., arm_kinds: _Optional[_Mapping[str, str]] = ...) -> None: ...
    class Close(_message.Message):
        __slots__ = ("room", "with_people")
        ROOM_FIELD_NUMBER: _ClassVar[int]
        WITH_PEOPLE_FIELD_NUMBER: _ClassVar[int]
        room: str
        with_people: bool
        def __init__(self, room: _Optional[str] = ..., with_people: _Optional[bool] = ...) -> None: ...
    OPEN_FIELD_NUMBER: _ClassVar[int]
    CLOSE_FIELD_NUMBER: _ClassVar[int]
    open: RoomsRequest.Open
    close: RoomsRequest.Close
    def __init__(self, open: _Optional[_Union[RoomsRequest.Open, _Mapping]] = ..., close: _Optional[_Union[RoomsRequest.Close, _Mapping]] = ...) -> None: ...

class Error(_message.Message):
    __slots__ = ("code", "message")
    CODE_FIELD_NUMBER: _ClassVar[int]
    MESSAGE_FIELD_NUMBER: _ClassVar[int]
    code: str
    message: str
    def __init__(self, code: _Optional[str] = ..., message: _Optional[str] = ...) -> None: ...

class RoomReply(_message.Message):
    __slots__ = ("error", "status", "seat")
    ERROR_FIELD_NUMBER: _ClassVar[int]
    STATUS_FIELD_NUMBER: _ClassVar[int]
    SEAT_FIELD_NUMBER: _ClassVar[int]
    error: Error
    status: RoomStatus
    seat: Seat
    def __init__(self, error: _Optional[_Union[Error, _Mapping]] = ..., status: _Optional[_Union[RoomStatus, _Mapping]] = ..., seat: _Optional[_Union[Seat, _Mapping]] = ...) -> None: ...

class Event(_message.Message):
    __slots__ = ("wall_ns", "room", "tick", "barrier_changed", "seat_changed", "episode_started", "episode_ended", "episode_saved", "world_reset", "notice", "latency", "cue_given", "no_picture", "picture_cost")
    class BarrierChanged(_message.Message):
        __slots__ = ("phase", "waiting_for")
        PHASE_FIELD_NUMBER: _ClassVar[int]
        WAITING_FOR_FIELD_NUMBER: _ClassVar[int]
        phase: BarrierPhase
        waiting_for: _containers.RepeatedCompositeFieldContainer[Waiting]
        def __init__(self, phase: _Optional[_Union[BarrierPhase, str]] = ..., waiting_for: _Optional[_Iterable[_Union[Waiting, _Mapping]]] = ...) -> None: ...
    class EpisodeStarted(_message.Message):
        __slots__ = ("number", "seed", "seats", "task", "control_hz", "model_sha256", "lockstep", "skill", "time_limit_s", "measured_arms", "captured_cameras")
        NUMBER_FIELD_NUMBER: _ClassVar[int]
        SEED_FIELD_NUMBER: _ClassVar[int]
        SEATS_FIELD_NUMBER: _ClassVar[int]
        TASK_FIELD_NUMBER: _ClassVar[int]
        CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
        MODEL_SHA256_FIELD_NUMBER: _ClassVar[int]
        LOCKSTEP_FIELD_NUMBER: _ClassVar[int]
        SKILL_FIELD_NUMBER: _ClassVar[int]
        TIME_LIMIT_S_FIELD_NUMBER: _ClassVar[int]
        MEASURED_ARMS_FIELD_NUMBER: _ClassVar[int]
        CAPTURED_CAMERAS_FIELD_NUMBER: _ClassVar[int]
        number: int
        seed: int
        seats: _containers.RepeatedCompositeFieldContainer[Seat]
        task: str
        control_hz: float
        model_sha256: str
        lockstep: bool
        skill: str
        time_limit_s: float
        measured_arms: _containers.RepeatedScalarFieldContainer[str]
        captured_cameras: _containers.RepeatedScalarFieldContainer[str]
        def __init__(self, number: _Optional[int] = ..., seed: _Optional[int] = ..., seats: _Optional[_Iterable[_Union[Seat, _Mapping]]] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., model_sha256: _Optional[str] = ..., lockstep: _Optional[bool] = ..., skill: _Optional[str] = ..., time_limit_s: _Optional[float] = ..., measured_arms: _Optional[_Iterable[str]] = ..., captured_cameras: _Optional[_Iterable[str]] = ...) -> None: ...
    class EpisodeEnded(_message.Message):
        __slots__ = ("number", "outcome", "ticks", "reason", "last_tick", "ended_by", "ended_by_name", "ended_by_arm", "subtasks_done", "subtasks")
        NUMBER_FIELD_NUMBER: _ClassVar[int]
        OUTCOME_FIELD_NUMBER: _ClassVar[int]
        TICKS_FIELD_NUMBER: _ClassVar[int]
        REASON_FIELD_NUMBER: _ClassVar[int]
        LAST_TICK_FIELD_NUMBER: _ClassVar[int]
        ENDED_BY_FIELD_NUMBER: _ClassVar[int]
        ENDED_BY_NAME_FIELD_NUMBER: _ClassVar[int]
        ENDED_BY_ARM_FIELD_NUMBER: _ClassVar[int]
        SUBTASKS_DONE_FIELD_NUMBER: _ClassVar[int]
        SUBTASKS_FIELD_NUMBER: _ClassVar[int]
        number: int
        outcome: Outcome
        ticks: int
        reason: str
        last_tick: int
        ended_by: EndedBy
        ended_by_name: str
        ended_by_arm: str
        subtasks_done: int
        subtasks: int
        def __init__(self, number: _Optional[int] = ..., outcome: _Optional[_Union[Outcome, str]] = ..., ticks: _Optional[int] = ..., reason: _Optional[str] = ..., last_tick: _Optional[int] = ..., ended_by: _Optional[_Union[EndedBy, str]] = ..., ended_by_name: _Optional[str] = ..., ended_by_arm: _Optional[str] = ..., subtasks_done: _Optional[int] = ..., subtasks: _Optional[int] = ...) -> None: ...
    class EpisodeSaved(_message.Message):
        __slots__ = ("number", "path", "verified", "verdict", "size_bytes", "outcome", "missing_ticks", "missing_commands")
        NUMBER_FIELD_NUMBER: _ClassVar[int]
        PATH_FIELD_NUMBER: _ClassVar[int]
        VERIFIED_FIELD_NUMBER: _ClassVar[int]
        VERDICT_FIELD_NUMBER: _ClassVar[int]
        SIZE_BYTES_FIELD_NUMBER: _ClassVar[int]
        OUTCOME_FIELD_NUMBER: _ClassVar[int]
        MISSING_TICKS_FIELD_NUMBER: _ClassVar[int]
        MISSING_COMMANDS_FIELD_NUMBER: _ClassVar[int]
        number: int
        path: str
        verified: bool
        verdict: str
        size_bytes: int
        outcome: Outcome
        missing_ticks: int
        missing_commands: int
        def __init__(self, number: _Optional[int] = ..., path: _Optional[str] = ..., verified: _Optional[bool] = ..., verdict: _Optional[str] = ..., size_bytes: _Optional[int] = ..., outcome: _Optional[_Union[Outcome, str]] = ..., missing_ticks: _Optional[int] = ..., missing_commands: _Optional[int] = ...) -> None: ...
    class WorldReset(_message.Message):
        __slots__ = ("seed",)
        SEED_FIELD_NUMBER: _ClassVar[int]
        seed: int
        def __init__(self, seed: _Optional[int] = ...) -> None: ...
    class Notice(_message.Message):
        __slots__ = ("level", "text")
        LEVEL_FIELD_NUMBER: _ClassVar[int]
        TEXT_FIELD_NUMBER: _ClassVar[int]
        FROM_FIELD_NUMBER: _ClassVar[int]
        level: str
        text: str
        def __init__(self, level: _Optional[str] = ..., text: _Optional[str] = ..., **kwargs) -> None: ...
    class Latency(_message.Message):
        __slots__ = ("arm", "p50_ms", "p95_ms", "frames", "stages", "drawn_in_page", "draw_p50_ms", "draw_p95_ms", "draws_per_s")
        class Stage(_message.Message):
            __slots__ = ("name", "p50_ms")
            NAME_FIELD_NUMBER: _ClassVar[int]
            P50_MS_FIELD_NUMBER: _ClassVar[int]
            name: str
            p50_ms: float
            def __init__(self, name: _Optional[str] = ..., p50_ms: _Optional[float] = ...) -> None: ...
        ARM_FIELD_NUMBER: _ClassVar[int]
        P50_MS_FIELD_NUMBER: _ClassVar[int]
        P95_MS_FIELD_NUMBER: _ClassVar[int]
        FRAMES_FIELD_NUMBER: _ClassVar[int]
        STAGES_FIELD_NUMBER: _ClassVar[int]
        DRAWN_IN_PAGE_FIELD_NUMBER: _ClassVar[int]
        DRAW_P50_MS_FIELD_NUMBER: _ClassVar[int]
        DRAW_P95_MS_FIELD_NUMBER: _ClassVar[int]
        DRAWS_PER_S_FIELD_NUMBER: _ClassVar[int]
        arm: str
        p50_ms: float
        p95_ms: float
        frames: int
        stages: _containers.RepeatedCompositeFieldContainer[Event.Latency.Stage]
        drawn_in_page: bool
        draw_p50_ms: float
        draw_p95_ms: float
        draws_per_s: float
        def __init__(self, arm: _Optional[str] = ..., p50_ms: _Optional[float] = ..., p95_ms: _Optional[float] = ..., frames: _Optional[int] = ..., stages: _Optional[_Iterable[_Union[Event.Latency.Stage, _Mapping]]] = ..., drawn_in_page: _Optional[bool] = ..., draw_p50_ms: _Optional[float] = ..., draw_p95_ms: _Optional[float] = ..., draws_per_s: _Optional[float] = ...) -> None: ...
    class CueGiven(_message.Message):
        __slots__ = ("arm", "cue")
        ARM_FIELD_NUMBER: _ClassVar[int]
        CUE_FIELD_NUMBER: _ClassVar[int]
        arm: str
        cue: Cue
        def __init__(self, arm: _Optional[str] = ..., cue: _Optional[_Union[Cue, str]] = ...) -> None: ...
    class NoPicture(_message.Message):
        __slots__ = ("arm", "reason")
        ARM_FIELD_NUMBER: _ClassVar[int]
        REASON_FIELD_NUMBER: _ClassVar[int]
        arm: str
        reason: str
        def __init__(self, arm: _Optional[str] = ..., reason: _Optional[str] = ...) -> None: ...
    class PictureCost(_message.Message):
        __slots__ = ("arm", "picture_ms")
        ARM_FIELD_NUMBER: _ClassVar[int]
        PICTURE_MS_FIELD_NUMBER: _ClassVar[int]
        arm: str
        picture_ms: float
        def __init__(self, arm: _Optional[str] = ..., picture_ms: _Optional[float] = ...) -> None: ...
    WALL_NS_FIELD_NUMBER: _ClassVar[int]
    ROOM_FIELD_NUMBER: _ClassVar[int]
    TICK_FIELD_NUMBER: _ClassVar[int]
    BARRIER_CHANGED_FIELD_NUMBER: _ClassVar[int]
    SEAT_CHANGED_FIELD_NUMBER: _ClassVar[int]
    EPISODE_STARTED_FIELD_NUMBER: _ClassVar[int]
    EPISODE_ENDED_FIELD_NUMBER: _ClassVar[int]
    EPISODE_SAVED_FIELD_NUMBER: _ClassVar[int]
    WORLD_RESET_FIELD_NUMBER: _ClassVar[int]
    NOTICE_FIELD_NUMBER: _ClassVar[int]
    LATENCY_FIELD_NUMBER: _ClassVar[int]
    CUE_GIVEN_FIELD_NUMBER: _ClassVar[int]
    NO_PICTURE_FIELD_NUMBER: _ClassVar[int]
    PICTURE_COST_FIELD_NUMBER: _ClassVar[int]
    wall_ns: int
    room: str
    tick: int
    barrier_changed: Event.BarrierChanged
    seat_changed: Seat
    episode_started: Event.EpisodeStarted
    episode_ended: Event.EpisodeEnded
    episode_saved: Event.EpisodeSaved
    world_reset: Event.WorldReset
    notice: Event.Notice
    latency: Event.Latency
    cue_given: Event.CueGiven
    no_picture: Event.NoPicture
    picture_cost: Event.PictureCost
    def __init__(self, wall_ns: _Optional[int] = ..., room: _Optional[str] = ..., tick: _Optional[int] = ..., barrier_changed: _Optional[_Union[Event.BarrierChanged, _Mapping]] = ..., seat_changed: _Optional[_Union[Seat, _Mapping]] = ..., episode_started: _Optional[_Union[Event.EpisodeStarted, _Mapping]] = ..., episode_ended: _Optional[_Union[Event.EpisodeEnded, _Mapping]] = ..., episode_saved: _Optional[_Union[Event.EpisodeSaved, _Mapping]] = ..., world_reset: _Optional[_Union[Event.WorldReset, _Mapping]] = ..., notice: _Optional[_Union[Event.Notice, _Mapping]] = ..., latency: _Optional[_Union[Event.Latency, _Mapping]] = ..., cue_given: _Optional[_Union[Event.CueGiven, _Mapping]] = ..., no_picture: _Optional[_Union[Event.NoPicture, _Mapping]] = ..., picture_cost: _Optional[_Union[Event.PictureCost, _Mapping]] = ...) -> None: ...

class RecordingReport(_message.Message):
    __slots__ = ("recorder", "boot", "episode", "last_tick")
    RECORDER_FIELD_NUMBER: _ClassVar[int]
    BOOT_FIELD_NUMBER: _ClassVar[int]
    EPISODE_FIELD_NUMBER: _ClassVar[int]
    LAST_TICK_FIELD_NUMBER: _ClassVar[int]
    recorder: str
    boot: int
    episode: int
    last_tick: int
    def __init__(self, recorder: _Optional[str] = ..., boot: _Optional[int] = ..., episode: _Optional[int] = ..., last_tick: _Optional[int] = ...) -> None: ...
