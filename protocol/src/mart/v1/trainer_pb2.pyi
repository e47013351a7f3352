from mart.v1 import room_pb2 as _room_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class JobState(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    JOB_STATE_UNSPECIFIED: _ClassVar[JobState]
    JOB_STATE_QUEUED: _ClassVar[JobState]
    JOB_STATE_RUNNING: _ClassVar[JobState]
    JOB_STATE_DONE: _ClassVar[JobState]
    JOB_STATE_FAILED: _ClassVar[JobState]
    JOB_STATE_CANCELLED: _ClassVar[JobState]
JOB_STATE_UNSPECIFIED: JobState
JOB_STATE_QUEUED: JobState
JOB_STATE_RUNNING: JobState
JOB_STATE_DONE: JobState
JOB_STATE_FAILED: JobState
JOB_STATE_CANCELLED: JobState

class Order(_message.Message):
    __slots__ = ("model", "task", "data", "preset", "seeds", "evaluation_episodes", "score_episodes", "dataset", "control_hz", "skip_idle_s")
    MODEL_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    DATA_FIELD_NUMBER: _ClassVar[int]
    PRESET_FIELD_NUMBER: _ClassVar[int]
    SEEDS_FIELD_NUMBER: _ClassVar[int]
    EVALUATION_EPISODES_FIELD_NUMBER: _ClassVar[int]
    SCORE_EPISODES_FIELD_NUMBER: _ClassVar[int]
    DATASET_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    SKIP_IDLE_S_FIELD_NUMBER: _ClassVar[int]
    model: str
    task: str
    data: str
    preset: str
    seeds: _containers.RepeatedScalarFieldContainer[int]
    evaluation_episodes: int
    score_episodes: int
    dataset: str
    control_hz: float
    skip_idle_s: float
    def __init__(self, model: _Optional[str] = ..., task: _Optional[str] = ..., data: _Optional[str] = ..., preset: _Optional[str] = ..., seeds: _Optional[_Iterable[int]] = ..., evaluation_episodes: _Optional[int] = ..., score_episodes: _Optional[int] = ..., dataset: _Optional[str] = ..., control_hz: _Optional[float] = ..., skip_idle_s: _Optional[float] = ...) -> None: ...

class Job(_message.Message):
    __slots__ = ("id", "sweep", "order", "state", "executor", "submitted_ns", "started_ns", "ended_ns", "attempt", "detail", "run", "progress")
    ID_FIELD_NUMBER: _ClassVar[int]
    SWEEP_FIELD_NUMBER: _ClassVar[int]
    ORDER_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    EXECUTOR_FIELD_NUMBER: _ClassVar[int]
    SUBMITTED_NS_FIELD_NUMBER: _ClassVar[int]
    STARTED_NS_FIELD_NUMBER: _ClassVar[int]
    ENDED_NS_FIELD_NUMBER: _ClassVar[int]
    ATTEMPT_FIELD_NUMBER: _ClassVar[int]
    DETAIL_FIELD_NUMBER: _ClassVar[int]
    RUN_FIELD_NUMBER: _ClassVar[int]
    PROGRESS_FIELD_NUMBER: _ClassVar[int]
    id: str
    sweep: str
    order: Order
    state: JobState
    executor: str
    submitted_ns: int
    started_ns: int
    ended_ns: int
    attempt: int
    detail: str
    run: str
    progress: JobProgress
    def __init__(self, id: _Optional[str] = ..., sweep: _Optional[str] = ..., order: _Optional[_Union[Order, _Mapping]] = ..., state: _Optional[_Union[JobState, str]] = ..., executor: _Optional[str] = ..., submitted_ns: _Optional[int] = ..., started_ns: _Optional[int] = ..., ended_ns: _Optional[int] = ..., attempt: _Optional[int] = ..., detail: _Optional[str] = ..., run: _Optional[str] = ..., progress: _Optional[_Union[JobProgress, _Mapping]] = ...) -> None: ...

class JobProgress(_message.Message):
    __slots__ = ("updates", "updates_in_all", "updates_per_s", "loss", "best_success", "stage")
    UPDATES_FIELD_NUMBER: _ClassVar[int]
    UPDATES_IN_ALL_FIELD_NUMBER: _ClassVar[int]
    UPDATES_PER_S_FIELD_NUMBER: _ClassVar[int]
    LOSS_FIELD_NUMBER: _ClassVar[int]
    BEST_SUCCESS_FIELD_NUMBER: _ClassVar[int]
    STAGE_FIELD_NUMBER: _ClassVar[int]
    updates: int
    updates_in_all: int
    updates_per_s: float
    loss: float
    best_success: float
    stage: str
    def __init__(self, updates: _Optional[int] = ..., updates_in_all: _Optional[int] = ..., updates_per_s: _Optional[float] = ..., loss: _Optional[float] = ..., best_success: _Optional[float] = ..., stage: _Optional[str] = ...) -> None: ...

class Curve(_message.Message):
    __slots__ = ("name", "updates", "values")
    NAME_FIELD_NUMBER: _ClassVar[int]
    UPDATES_FIELD_NUMBER: _ClassVar[int]
    VALUES_FIELD_NUMBER: _ClassVar[int]
    name: str
    updates: _containers.RepeatedScalarFieldContainer[int]
    values: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, name: _Optional[str] = ..., updates: _Optional[_Iterable[int]] = ..., values: _Optional[_Iterable[float]] = ...) -> None: ...

class Learned(_message.Message):
    __slots__ = ("episodes", "ticks", "sha256", "dataset", "dataset_episodes", "left_out", "control_hz")
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    TICKS_FIELD_NUMBER: _ClassVar[int]
    SHA256_FIELD_NUMBER: _ClassVar[int]
    DATASET_FIELD_NUMBER: _ClassVar[int]
    DATASET_EPISODES_FIELD_NUMBER: _ClassVar[int]
    LEFT_OUT_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    episodes: int
    ticks: int
    sha256: str
    dataset: str
    dataset_episodes: int
    left_out: _containers.RepeatedScalarFieldContainer[str]
    control_hz: float
    def __init__(self, episodes: _Optional[int] = ..., ticks: _Optional[int] = ..., sha256: _Optional[str] = ..., dataset: _Optional[str] = ..., dataset_episodes: _Optional[int] = ..., left_out: _Optional[_Iterable[str]] = ..., control_hz: _Optional[float] = ...) -> None: ...

class SubtaskCount(_message.Message):
    __slots__ = ("name", "episodes")
    NAME_FIELD_NUMBER: _ClassVar[int]
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    name: str
    episodes: int
    def __init__(self, name: _Optional[str] = ..., episodes: _Optional[int] = ...) -> None: ...

class Rollout(_message.Message):
    __slots__ = ("name", "seed", "outcome", "detail", "time_s")
    NAME_FIELD_NUMBER: _ClassVar[int]
    SEED_FIELD_NUMBER: _ClassVar[int]
    OUTCOME_FIELD_NUMBER: _ClassVar[int]
    DETAIL_FIELD_NUMBER: _ClassVar[int]
    TIME_S_FIELD_NUMBER: _ClassVar[int]
    name: str
    seed: int
    outcome: str
    detail: str
    time_s: float
    def __init__(self, name: _Optional[str] = ..., seed: _Optional[int] = ..., outcome: _Optional[str] = ..., detail: _Optional[str] = ..., time_s: _Optional[float] = ...) -> None: ...

class Evaluation(_message.Message):
    __slots__ = ("seed", "updates", "checkpoint", "purpose", "episodes", "successes", "low", "high", "mean_success_time_s", "done", "failures", "rollouts")
    SEED_FIELD_NUMBER: _ClassVar[int]
    UPDATES_FIELD_NUMBER: _ClassVar[int]
    CHECKPOINT_FIELD_NUMBER: _ClassVar[int]
    PURPOSE_FIELD_NUMBER: _ClassVar[int]
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    SUCCESSES_FIELD_NUMBER: _ClassVar[int]
    LOW_FIELD_NUMBER: _ClassVar[int]
    HIGH_FIELD_NUMBER: _ClassVar[int]
    MEAN_SUCCESS_TIME_S_FIELD_NUMBER: _ClassVar[int]
    DONE_FIELD_NUMBER: _ClassVar[int]
    FAILURES_FIELD_NUMBER: _ClassVar[int]
    ROLLOUTS_FIELD_NUMBER: _ClassVar[int]
    seed: int
    updates: int
    checkpoint: str
    purpose: str
    episodes: int
    successes: int
    low: float
    high: float
    mean_success_time_s: float
    done: _containers.RepeatedCompositeFieldContainer[SubtaskCount]
    failures: _containers.RepeatedCompositeFieldContainer[SubtaskCount]
    rollouts: _containers.RepeatedCompositeFieldContainer[Rollout]
    def __init__(self, seed: _Optional[int] = ..., updates: _Optional[int] = ..., checkpoint: _Optional[str] = ..., purpose: _Optional[str] = ..., episodes: _Optional[int] = ..., successes: _Optional[int] = ..., low: _Optional[float] = ..., high: _Optional[float] = ..., mean_success_time_s: _Optional[float] = ..., done: _Optional[_Iterable[_Union[SubtaskCount, _Mapping]]] = ..., failures: _Optional[_Iterable[_Union[SubtaskCount, _Mapping]]] = ..., rollouts: _Optional[_Iterable[_Union[Rollout, _Mapping]]] = ...) -> None: ...

class Policy(_message.Message):
    __slots__ = ("name", "model", "task", "control_hz", "arms", "joint", "seed", "updates", "job", "evaluation", "promoted_ns", "arm_kinds")
    NAME_FIELD_NUMBER: _ClassVar[int]
    MODEL_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    ARMS_FIELD_NUMBER: _ClassVar[int]
    JOINT_FIELD_NUMBER: _ClassVar[int]
    SEED_FIELD_NUMBER: _ClassVar[int]
    UPDATES_FIELD_NUMBER: _ClassVar[int]
    JOB_FIELD_NUMBER: _ClassVar[int]
    EVALUATION_FIELD_NUMBER: _ClassVar[int]
    PROMOTED_NS_FIELD_NUMBER: _ClassVar[int]
    ARM_KINDS_FIELD_NUMBER: _ClassVar[int]
    name: str
    model: str
    task: str
    control_hz: float
    arms: _containers.RepeatedScalarFieldContainer[str]
    joint: bool
    seed: int
    updates: int
    job: str
    evaluation: Evaluation
    promoted_ns: int
    arm_kinds: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, name: _Optional[str] = ..., model: _Optional[str] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., arms: _Optional[_Iterable[str]] = ..., joint: _Optional[bool] = ..., seed: _Optional[int] = ..., updates: _Optional[int] = ..., job: _Optional[str] = ..., evaluation: _Optional[_Union[Evaluation, _Mapping]] = ..., promoted_ns: _Optional[int] = ..., arm_kinds: _Optional[_Iterable[str]] = ...) -> None: ...

class DataSet(_message.Message):
    __slots__ = ("path", "episodes", "tasks", "name", "left_out", "sha256")
    PATH_FIELD_NUMBER: _ClassVar[int]
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    TASKS_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    LEFT_OUT_FIELD_NUMBER: _ClassVar[int]
    SHA256_FIELD_NUMBER: _ClassVar[int]
    path: str
    episodes: int
    tasks: _containers.RepeatedScalarFieldContainer[str]
    name: str
    left_out: int
    sha256: str
    def __init__(self, path: _Optional[str] = ..., episodes: _Optional[int] = ..., tasks: _Optional[_Iterable[str]] = ..., name: _Optional[str] = ..., left_out: _Optional[int] = ..., sha256: _Optional[str] = ...) -> None: ...

class TrainerRequest(_message.Message):
    __slots__ = ("choices", "submit", "list", "show", "logs", "cancel", "retry", "promote", "policies", "withdraw", "video")
    class Choices(_message.Message):
        __slots__ = ()
        def __init__(self) -> None: ...
    class Submit(_message.Message):
        __slots__ = ("models", "tasks", "order", "seeds_per_job", "executor")
        MODELS_FIELD_NUMBER: _ClassVar[int]
        TASKS_FIELD_NUMBER: _ClassVar[int]
        ORDER_FIELD_NUMBER: _ClassVar[int]
        SEEDS_PER_JOB_FIELD_NUMBER: _ClassVar[int]
        EXECUTOR_FIELD_NUMBER: _ClassVar[int]
        models: _containers.RepeatedScalarFieldContainer[str]
        tasks: _containers.RepeatedScalarFieldContainer[str]
        order: Order
        seeds_per_job: int
        executor: str
        def __init__(self, models: _Optional[_Iterable[str]] = ..., tasks: _Optional[_Iterable[str]] = ..., order: _Optional[_Union[Order, _Mapping]] = ..., seeds_per_job: _Optional[int] = ..., executor: _Optional[str] = ...) -> None: ...
    class List(_message.Message):
        __slots__ = ("sweep", "newest")
        SWEEP_FIELD_NUMBER: _ClassVar[int]
        NEWEST_FIELD_NUMBER: _ClassVar[int]
        sweep: str
        newest: int
        def __init__(self, sweep: _Optional[str] = ..., newest: _Optional[int] = ...) -> None: ...
    class Show(_message.Message):
        __slots__ = ("job", "since_updates")
        JOB_FIELD_NUMBER: _ClassVar[int]
        SINCE_UPDATES_FIELD_NUMBER: _ClassVar[int]
        job: str
        since_updates: int
        def __init__(self, job: _Optional[str] = ..., since_updates: _Optional[int] = ...) -> None: ...
    class Logs(_message.Message):
        __slots__ = ("job", "tail_bytes")
        JOB_FIELD_NUMBER: _ClassVar[int]
        TAIL_BYTES_FIELD_NUMBER: _ClassVar[int]
        job: str
        tail_bytes: int
        def __init__(self, job: _Optional[str] = ..., tail_bytes: _Optional[int] = ...) -> None: ...
    class Cancel(_message.Message):
        __slots__ = ("job",)
        JOB_FIELD_NUMBER: _ClassVar[int]
        job: str
        def __init__(self, job: _Optional[str] = ...) -> None: ...
    class Retry(_message.Message):
        __slots__ = ("job",)
        JOB_FIELD_NUMBER: _ClassVar[int]
        job: str
        def __init__(self, job: _Optional[str] = ...) -> None: ...
    class Promote(_message.Message):
        __slots__ = ("job", "checkpoint", "name")
        JOB_FIELD_NUMBER: _ClassVar[int]
        CHECKPOINT_FIELD_NUMBER: _ClassVar[int]
        NAME_FIELD_NUMBER: _ClassVar[int]
        job: str
        checkpoint: str
        name: str
        def __init__(self, job: _Optional[str] = ..., checkpoint: _Optional[str] = ..., name: _Optional[str] = ...) -> None: ...
    class Policies(_message.Message):
        __slots__ = ("task",)
        TASK_FIELD_NUMBER: _ClassVar[int]
        task: str
        def __init__(self, task: _Optional[str] = ...) -> None: ...
    class Withdraw(_message.Message):
        __slots__ = ("policy",)
        POLICY_FIELD_NUMBER: _ClassVar[int]
        policy: str
        def __init__(self, policy: _Optional[str] = ...) -> None: ...
    class Video(_message.Message):
        __slots__ = ("job", "rollout", "offset")
        JOB_FIELD_NUMBER: _ClassVar[int]
        ROLLOUT_FIELD_NUMBER: _ClassVar[int]
        OFFSET_FIELD_NUMBER: _ClassVar[int]
        job: str
        rollout: str
        offset: int
        def __init__(self, job: _Optional[str] = ..., rollout: _Optional[str] = ..., offset: _Optional[int] = ...) -> None: ...
    CHOICES_FIELD_NUMBER: _ClassVar[int]
    SUBMIT_FIELD_NUMBER: _ClassVar[int]
    LIST_FIELD_NUMBER: _ClassVar[int]
    SHOW_FIELD_NUMBER: _ClassVar[int]
    LOGS_FIELD_NUMBER: _ClassVar[int]
    CANCEL_FIELD_NUMBER: _ClassVar[int]
    RETRY_FIELD_NUMBER: _ClassVar[int]
    PROMOTE_FIELD_NUMBER: _ClassVar[int]
    POLICIES_FIELD_NUMBER: _ClassVar[int]
    WITHDRAW_FIELD_NUMBER: _ClassVar[int]
    VIDEO_FIELD_NUMBER: _ClassVar[int]
    choices: TrainerRequest.Choices
    submit: TrainerRequest.Submit
    list: TrainerRequest.List
    show: TrainerRequest.Show
    logs: TrainerRequest.Logs
    cancel: TrainerRequest.Cancel
    retry: TrainerRequest.Retry
    promote: TrainerRequest.Promote
    policies: TrainerRequest.Policies
    withdraw: TrainerRequest.Withdraw
    video: TrainerRequest.Video
    def __init__(self, choices: _Optional[_Union[TrainerRequest.Choices, _Mapping]] = ..., submit: _Optional[_Union[TrainerRequest.Submit, _Mapping]] = ..., list: _Optional[_Union[TrainerRequest.List, _Mapping]] = ..., show: _Optional[_Union[TrainerRequest.Show, _Mapping]] = ..., logs: _Optional[_Union[TrainerRequest.Logs, _Mapping]] = ..., cancel: _Optional[_Union[TrainerRequest.Cancel, _Mapping]] = ..., retry: _Optional[_Union[TrainerRequest.Retry, _Mapping]] = ..., promote: _Optional[_Union[TrainerRequest.Promote, _Mapping]] = ..., policies: _Optional[_Union[TrainerRequest.Policies, _Mapping]] = ..., withdraw: _Optional[_Union[TrainerRequest.Withdraw, _Mapping]] = ..., video: _Optional[_Union[TrainerRequest.Video, _Mapping]] = ...) -> None: ...

class TrainerReply(_message.Message):
    __slots__ = ("error", "choices", "jobs", "details", "log", "policies", "video")
    class Choices(_message.Message):
        __slots__ = ("models", "tasks", "presets", "data", "executors", "device", "order")
        class Model(_message.Message):
            __slots__ = ("name", "planner", "actor", "residual", "about")
            NAME_FIELD_NUMBER: _ClassVar[int]
            PLANNER_FIELD_NUMBER: _ClassVar[int]
            ACTOR_FIELD_NUMBER: _ClassVar[int]
            RESIDUAL_FIELD_NUMBER: _ClassVar[int]
            ABOUT_FIELD_NUMBER: _ClassVar[int]
            name: str
            planner: str
            actor: str
            residual: str
            about: str
            def __init__(self, name: _Optional[str] = ..., planner: _Optional[str] = ..., actor: _Optional[str] = ..., residual: _Optional[str] = ..., about: _Optional[str] = ...) -> None: ...
        MODELS_FIELD_NUMBER: _ClassVar[int]
        TASKS_FIELD_NUMBER: _ClassVar[int]
        PRESETS_FIELD_NUMBER: _ClassVar[int]
        DATA_FIELD_NUMBER: _ClassVar[int]
        EXECUTORS_FIELD_NUMBER: _ClassVar[int]
        DEVICE_FIELD_NUMBER: _ClassVar[int]
        ORDER_FIELD_NUMBER: _ClassVar[int]
        models: _containers.RepeatedCompositeFieldContainer[TrainerReply.Choices.Model]
        tasks: _containers.RepeatedScalarFieldContainer[str]
        presets: _containers.RepeatedScalarFieldContainer[str]
        data: _containers.RepeatedCompositeFieldContainer[DataSet]
        executors: _containers.RepeatedScalarFieldContainer[str]
        device: str
        order: Order
        def __init__(self, models: _Optional[_Iterable[_Union[TrainerReply.Choices.Model, _Mapping]]] = ..., tasks: _Optional[_Iterable[str]] = ..., presets: _Optional[_Iterable[str]] = ..., data: _Optional[_Iterable[_Union[DataSet, _Mapping]]] = ..., executors: _Optional[_Iterable[str]] = ..., device: _Optional[str] = ..., order: _Optional[_Union[Order, _Mapping]] = ...) -> None: ...
    class Details(_message.Message):
        __slots__ = ("job", "curves", "evaluations", "checkpoints", "learned")
        JOB_FIELD_NUMBER: _ClassVar[int]
        CURVES_FIELD_NUMBER: _ClassVar[int]
        EVALUATIONS_FIELD_NUMBER: _ClassVar[int]
        CHECKPOINTS_FIELD_NUMBER: _ClassVar[int]
        LEARNED_FIELD_NUMBER: _ClassVar[int]
        job: Job
        curves: _containers.RepeatedCompositeFieldContainer[Curve]
        evaluations: _containers.RepeatedCompositeFieldContainer[Evaluation]
        checkpoints: _containers.RepeatedScalarFieldContainer[str]
        learned: Learned
        def __init__(self, job: _Optional[_Union[Job, _Mapping]] = ..., curves: _Optional[_Iterable[_Union[Curve, _Mapping]]] = ..., evaluations: _Optional[_Iterable[_Union[Evaluation, _Mapping]]] = ..., checkpoints: _Optional[_Iterable[str]] = ..., learned: _Optional[_Union[Learned, _Mapping]] = ...) -> None: ...
    class Video(_message.Message):
        __slots__ = ("ready", "piece", "size_bytes")
        READY_FIELD_NUMBER: _ClassVar[int]
        PIECE_FIELD_NUMBER: _ClassVar[int]
        SIZE_BYTES_FIELD_NUMBER: _ClassVar[int]
        ready: bool
        piece: bytes
        size_bytes: int
        def __init__(self, ready: _Optional[bool] = ..., piece: _Optional[bytes] = ..., size_bytes: _Optional[int] = ...) -> None: ...
    ERROR_FIELD_NUMBER: _ClassVar[int]
    CHOICES_FIELD_NUMBER: _ClassVar[int]
    JOBS_FIELD_NUMBER: _ClassVar[int]
    DETAILS_FIELD_NUMBER: _ClassVar[int]
    LOG_FIELD_NUMBER: _ClassVar[int]
    POLICIES_FIELD_NUMBER: _ClassVar[int]
    VIDEO_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    choices: TrainerReply.Choices
    jobs: _containers.RepeatedCompositeFieldContainer[Job]
    details: TrainerReply.Details
    log: bytes
    policies: _containers.RepeatedCompositeFieldContainer[Policy]
    video: TrainerReply.Video
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., choices: _Optional[_Union[TrainerReply.Choices, _Mapping]] = ..., jobs: _Optional[_Iterable[_Union[Job, _Mapping]]] = ..., details: _Optional[_Union[TrainerReply.Details, _Mapping]] = ..., log: _Optional[bytes] = ..., policies: _Optional[_Iterable[_Union[Policy, _Mapping]]] = ..., video: _Optional[_Union[TrainerReply.Video, _Mapping]] = ...) -> None: ...
