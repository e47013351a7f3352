from mart.v1 import room_pb2 as _room_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RecordedEpisode(_message.Message):
    __slots__ = ("path", "size_bytes", "room", "number", "task", "control_hz", "outcome", "verdict", "reason", "ticks", "simulated_s", "mode", "skill", "real_time_factor", "missing_ticks", "waited_s", "started_ns", "complete", "repaired", "interrupted", "operators", "error", "note", "dropped", "datasets", "missing_commands", "ended_by", "ended_by_name", "ended_by_arm", "subtasks_done", "subtasks", "outcome_by", "verification_pending")
    class OperatorsEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: str
        def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
    PATH_FIELD_NUMBER: _ClassVar[int]
    SIZE_BYTES_FIELD_NUMBER: _ClassVar[int]
    ROOM_FIELD_NUMBER: _ClassVar[int]
    NUMBER_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    CONTROL_HZ_FIELD_NUMBER: _ClassVar[int]
    OUTCOME_FIELD_NUMBER: _ClassVar[int]
    VERDICT_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    TICKS_FIELD_NUMBER: _ClassVar[int]
    SIMULATED_S_FIELD_NUMBER: _ClassVar[int]
    MODE_FIELD_NUMBER: _ClassVar[int]
    SKILL_FIELD_NUMBER: _ClassVar[int]
    REAL_TIME_FACTOR_FIELD_NUMBER: _ClassVar[int]
    MISSING_TICKS_FIELD_NUMBER: _ClassVar[int]
    WAITED_S_FIELD_NUMBER: _ClassVar[int]
    STARTED_NS_FIELD_NUMBER: _ClassVar[int]
    COMPLETE_FIELD_NUMBER: _ClassVar[int]
    REPAIRED_FIELD_NUMBER: _ClassVar[int]
    INTERRUPTED_FIELD_NUMBER: _ClassVar[int]
    OPERATORS_FIELD_NUMBER: _ClassVar[int]
    ERROR_FIELD_NUMBER: _ClassVar[int]
    NOTE_FIELD_NUMBER: _ClassVar[int]
    DROPPED_FIELD_NUMBER: _ClassVar[int]
    DATASETS_FIELD_NUMBER: _ClassVar[int]
    MISSING_COMMANDS_FIELD_NUMBER: _ClassVar[int]
    ENDED_BY_FIELD_NUMBER: _ClassVar[int]
    ENDED_BY_NAME_FIELD_NUMBER: _ClassVar[int]
    ENDED_BY_ARM_FIELD_NUMBER: _ClassVar[int]
    SUBTASKS_DONE_FIELD_NUMBER: _ClassVar[int]
    SUBTASKS_FIELD_NUMBER: _ClassVar[int]
    OUTCOME_BY_FIELD_NUMBER: _ClassVar[int]
    VERIFICATION_PENDING_FIELD_NUMBER: _ClassVar[int]
    path: str
    size_bytes: int
    room: str
    number: int
    task: str
    control_hz: float
    outcome: str
    verdict: str
    reason: str
    ticks: int
    simulated_s: float
    mode: str
    skill: str
    real_time_factor: float
    missing_ticks: int
    waited_s: float
    started_ns: int
    complete: bool
    repaired: bool
    interrupted: bool
    operators: _containers.ScalarMap[str, str]
    error: str
    note: str
    dropped: bool
    datasets: _containers.RepeatedScalarFieldContainer[str]
    missing_commands: int
    ended_by: str
    ended_by_name: str
    ended_by_arm: str
    subtasks_done: int
    subtasks: int
    outcome_by: str
    verification_pending: bool
    def __init__(self, path: _Optional[str] = ..., size_bytes: _Optional[int] = ..., room: _Optional[str] = ..., number: _Optional[int] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., outcome: _Optional[str] = ..., verdict: _Optional[str] = ..., reason: _Optional[str] = ..., ticks: _Optional[int] = ..., simulated_s: _Optional[float] = ..., mode: _Optional[str] = ..., skill: _Optional[str] = ..., real_time_factor: _Optional[float] = ..., missing_ticks: _Optional[int] = ..., waited_s: _Optional[float] = ..., started_ns: _Optional[int] = ..., complete: _Optional[bool] = ..., repaired: _Optional[bool] = ..., interrupted: _Optional[bool] = ..., operators: _Optional[_Mapping[str, str]] = ..., error: _Optional[str] = ..., note: _Optional[str] = ..., dropped: _Optional[bool] = ..., datasets: _Optional[_Iterable[str]] = ..., missing_commands: _Optional[int] = ..., ended_by: _Optional[str] = ..., ended_by_name: _Optional[str] = ..., ended_by_arm: _Optional[str] = ..., subtasks_done: _Optional[int] = ..., subtasks: _Optional[int] = ..., outcome_by: _Optional[str] = ..., verification_pending: _Optional[bool] = ...) -> None: ...

class Span(_message.Message):
    __slots__ = ("begin_s", "end_s", "text")
    BEGIN_S_FIELD_NUMBER: _ClassVar[int]
    END_S_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    begin_s: float
    end_s: float
    text: str
    def __init__(self, begin_s: _Optional[float] = ..., end_s: _Optional[float] = ..., text: _Optional[str] = ...) -> None: ...

class Lane(_message.Message):
    __slots__ = ("kind", "name", "spans")
    KIND_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    SPANS_FIELD_NUMBER: _ClassVar[int]
    kind: str
    name: str
    spans: _containers.RepeatedCompositeFieldContainer[Span]
    def __init__(self, kind: _Optional[str] = ..., name: _Optional[str] = ..., spans: _Optional[_Iterable[_Union[Span, _Mapping]]] = ...) -> None: ...

class Trace(_message.Message):
    __slots__ = ("arm", "quantity", "unit", "seconds", "values")
    ARM_FIELD_NUMBER: _ClassVar[int]
    QUANTITY_FIELD_NUMBER: _ClassVar[int]
    UNIT_FIELD_NUMBER: _ClassVar[int]
    SECONDS_FIELD_NUMBER: _ClassVar[int]
    VALUES_FIELD_NUMBER: _ClassVar[int]
    arm: str
    quantity: str
    unit: str
    seconds: _containers.RepeatedScalarFieldContainer[float]
    values: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, arm: _Optional[str] = ..., quantity: _Optional[str] = ..., unit: _Optional[str] = ..., seconds: _Optional[_Iterable[float]] = ..., values: _Optional[_Iterable[float]] = ...) -> None: ...

class RecordedView(_message.Message):
    __slots__ = ("camera", "start_s")
    CAMERA_FIELD_NUMBER: _ClassVar[int]
    START_S_FIELD_NUMBER: _ClassVar[int]
    camera: str
    start_s: float
    def __init__(self, camera: _Optional[str] = ..., start_s: _Optional[float] = ...) -> None: ...

class NamedDataSet(_message.Message):
    __slots__ = ("name", "episodes", "sha256", "created_ns")
    NAME_FIELD_NUMBER: _ClassVar[int]
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    SHA256_FIELD_NUMBER: _ClassVar[int]
    CREATED_NS_FIELD_NUMBER: _ClassVar[int]
    name: str
    episodes: int
    sha256: str
    created_ns: int
    def __init__(self, name: _Optional[str] = ..., episodes: _Optional[int] = ..., sha256: _Optional[str] = ..., created_ns: _Optional[int] = ...) -> None: ...

class CatalogueRequest(_message.Message):
    __slots__ = ("list", "show", "label", "file", "video", "picture", "curate", "undo", "scene", "motion")
    class List(_message.Message):
        __slots__ = ("task", "outcome", "verdict", "operator", "room", "offset", "count", "skill", "dataset", "since_ns")
        TASK_FIELD_NUMBER: _ClassVar[int]
        OUTCOME_FIELD_NUMBER: _ClassVar[int]
        VERDICT_FIELD_NUMBER: _ClassVar[int]
        OPERATOR_FIELD_NUMBER: _ClassVar[int]
        ROOM_FIELD_NUMBER: _ClassVar[int]
        OFFSET_FIELD_NUMBER: _ClassVar[int]
        COUNT_FIELD_NUMBER: _ClassVar[int]
        SKILL_FIELD_NUMBER: _ClassVar[int]
        DATASET_FIELD_NUMBER: _ClassVar[int]
        SINCE_NS_FIELD_NUMBER: _ClassVar[int]
        task: str
        outcome: str
        verdict: str
        operator: str
        room: str
        offset: int
        count: int
        skill: str
        dataset: str
        since_ns: int
        def __init__(self, task: _Optional[str] = ..., outcome: _Optional[str] = ..., verdict: _Optional[str] = ..., operator: _Optional[str] = ..., room: _Optional[str] = ..., offset: _Optional[int] = ..., count: _Optional[int] = ..., skill: _Optional[str] = ..., dataset: _Optional[str] = ..., since_ns: _Optional[int] = ...) -> None: ...
    class Show(_message.Message):
        __slots__ = ("path",)
        PATH_FIELD_NUMBER: _ClassVar[int]
        path: str
        def __init__(self, path: _Optional[str] = ...) -> None: ...
    class Label(_message.Message):
        __slots__ = ("path", "outcome", "note", "dropped", "by")
        PATH_FIELD_NUMBER: _ClassVar[int]
        OUTCOME_FIELD_NUMBER: _ClassVar[int]
        NOTE_FIELD_NUMBER: _ClassVar[int]
        DROPPED_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        path: str
        outcome: str
        note: str
        dropped: bool
        by: str
        def __init__(self, path: _Optional[str] = ..., outcome: _Optional[str] = ..., note: _Optional[str] = ..., dropped: _Optional[bool] = ..., by: _Optional[str] = ...) -> None: ...
    class File(_message.Message):
        __slots__ = ("path", "offset")
        PATH_FIELD_NUMBER: _ClassVar[int]
        OFFSET_FIELD_NUMBER: _ClassVar[int]
        path: str
        offset: int
        def __init__(self, path: _Optional[str] = ..., offset: _Optional[int] = ...) -> None: ...
    class Video(_message.Message):
        __slots__ = ("path", "camera", "offset")
        PATH_FIELD_NUMBER: _ClassVar[int]
        CAMERA_FIELD_NUMBER: _ClassVar[int]
        OFFSET_FIELD_NUMBER: _ClassVar[int]
        path: str
        camera: str
        offset: int
        def __init__(self, path: _Optional[str] = ..., camera: _Optional[str] = ..., offset: _Optional[int] = ...) -> None: ...
    class Picture(_message.Message):
        __slots__ = ("path",)
        PATH_FIELD_NUMBER: _ClassVar[int]
        path: str
        def __init__(self, path: _Optional[str] = ...) -> None: ...
    class Curate(_message.Message):
        __slots__ = ("dataset", "take_out", "paths", "all", "by")
        DATASET_FIELD_NUMBER: _ClassVar[int]
        TAKE_OUT_FIELD_NUMBER: _ClassVar[int]
        PATHS_FIELD_NUMBER: _ClassVar[int]
        ALL_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        dataset: str
        take_out: bool
        paths: _containers.RepeatedScalarFieldContainer[str]
        all: CatalogueRequest.List
        by: str
        def __init__(self, dataset: _Optional[str] = ..., take_out: _Optional[bool] = ..., paths: _Optional[_Iterable[str]] = ..., all: _Optional[_Union[CatalogueRequest.List, _Mapping]] = ..., by: _Optional[str] = ...) -> None: ...
    class Undo(_message.Message):
        __slots__ = ("dataset", "act_ns", "by")
        DATASET_FIELD_NUMBER: _ClassVar[int]
        ACT_NS_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        dataset: str
        act_ns: int
        by: str
        def __init__(self, dataset: _Optional[str] = ..., act_ns: _Optional[int] = ..., by: _Optional[str] = ...) -> None: ...
    class Scene(_message.Message):
        __slots__ = ("path", "offset", "known_sha256")
        PATH_FIELD_NUMBER: _ClassVar[int]
        OFFSET_FIELD_NUMBER: _ClassVar[int]
        KNOWN_SHA256_FIELD_NUMBER: _ClassVar[int]
        path: str
        offset: int
        known_sha256: _containers.RepeatedScalarFieldContainer[str]
        def __init__(self, path: _Optional[str] = ..., offset: _Optional[int] = ..., known_sha256: _Optional[_Iterable[str]] = ...) -> None: ...
    class Motion(_message.Message):
        __slots__ = ("path", "offset", "simulated")
        PATH_FIELD_NUMBER: _ClassVar[int]
        OFFSET_FIELD_NUMBER: _ClassVar[int]
        SIMULATED_FIELD_NUMBER: _ClassVar[int]
        path: str
        offset: int
        simulated: bool
        def __init__(self, path: _Optional[str] = ..., offset: _Optional[int] = ..., simulated: _Optional[bool] = ...) -> None: ...
    LIST_FIELD_NUMBER: _ClassVar[int]
    SHOW_FIELD_NUMBER: _ClassVar[int]
    LABEL_FIELD_NUMBER: _ClassVar[int]
    FILE_FIELD_NUMBER: _ClassVar[int]
    VIDEO_FIELD_NUMBER: _ClassVar[int]
    PICTURE_FIELD_NUMBER: _ClassVar[int]
    CURATE_FIELD_NUMBER: _ClassVar[int]
    UNDO_FIELD_NUMBER: _ClassVar[int]
    SCENE_FIELD_NUMBER: _ClassVar[int]
    MOTION_FIELD_NUMBER: _ClassVar[int]
    list: CatalogueRequest.List
    show: CatalogueRequest.Show
    label: CatalogueRequest.Label
    file: CatalogueRequest.File
    video: CatalogueRequest.Video
    picture: CatalogueRequest.Picture
    curate: CatalogueRequest.Curate
    undo: CatalogueRequest.Undo
    scene: CatalogueRequest.Scene
    motion: CatalogueRequest.Motion
    def __init__(self, list: _Optional[_Union[CatalogueRequest.List, _Mapping]] = ..., show: _Optional[_Union[CatalogueRequest.Show, _Mapping]] = ..., label: _Optional[_Union[CatalogueRequest.Label, _Mapping]] = ..., file: _Optional[_Union[CatalogueRequest.File, _Mapping]] = ..., video: _Optional[_Union[CatalogueRequest.Video, _Mapping]] = ..., picture: _Optional[_Union[CatalogueRequest.Picture, _Mapping]] = ..., curate: _Optional[_Union[CatalogueRequest.Curate, _Mapping]] = ..., undo: _Optional[_Union[CatalogueRequest.Undo, _Mapping]] = ..., scene: _Optional[_Union[CatalogueRequest.Scene, _Mapping]] = ..., motion: _Optional[_Union[CatalogueRequest.Motion, _Mapping]] = ...) -> None: ...

class CatalogueReply(_message.Message):
    __slots__ = ("error", "listing", "details", "episode", "piece", "curated")
    class DriverStatistics(_message.Message):
        __slots__ = ("name", "episodes", "successes", "simulated_s")
        NAME_FIELD_NUMBER: _ClassVar[int]
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        SUCCESSES_FIELD_NUMBER: _ClassVar[int]
        SIMULATED_S_FIELD_NUMBER: _ClassVar[int]
        name: str
        episodes: int
        successes: int
        simulated_s: float
        def __init__(self, name: _Optional[str] = ..., episodes: _Optional[int] = ..., successes: _Optional[int] = ..., simulated_s: _Optional[float] = ...) -> None: ...
    class Listing(_message.Message):
        __slots__ = ("episodes", "matching", "successes", "tasks", "operators", "datasets", "skills", "simulated_s", "drivers")
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        MATCHING_FIELD_NUMBER: _ClassVar[int]
        SUCCESSES_FIELD_NUMBER: _ClassVar[int]
        TASKS_FIELD_NUMBER: _ClassVar[int]
        OPERATORS_FIELD_NUMBER: _ClassVar[int]
        DATASETS_FIELD_NUMBER: _ClassVar[int]
        SKILLS_FIELD_NUMBER: _ClassVar[int]
        SIMULATED_S_FIELD_NUMBER: _ClassVar[int]
        DRIVERS_FIELD_NUMBER: _ClassVar[int]
        episodes: _containers.RepeatedCompositeFieldContainer[RecordedEpisode]
        matching: int
        successes: int
        tasks: _containers.RepeatedScalarFieldContainer[str]
        operators: _containers.RepeatedScalarFieldContainer[str]
        datasets: _containers.RepeatedCompositeFieldContainer[NamedDataSet]
        skills: _containers.RepeatedScalarFieldContainer[str]
        simulated_s: float
        drivers: _containers.RepeatedCompositeFieldContainer[CatalogueReply.DriverStatistics]
        def __init__(self, episodes: _Optional[_Iterable[_Union[RecordedEpisode, _Mapping]]] = ..., matching: _Optional[int] = ..., successes: _Optional[int] = ..., tasks: _Optional[_Iterable[str]] = ..., operators: _Optional[_Iterable[str]] = ..., datasets: _Optional[_Iterable[_Union[NamedDataSet, _Mapping]]] = ..., skills: _Optional[_Iterable[str]] = ..., simulated_s: _Optional[float] = ..., drivers: _Optional[_Iterable[_Union[CatalogueReply.DriverStatistics, _Mapping]]] = ...) -> None: ...
    class Details(_message.Message):
        __slots__ = ("episode", "wall_s", "lanes", "traces", "views", "cadence", "versions", "verification", "simulated", "viewpoints")
        class CadenceEntry(_message.Message):
            __slots__ = ("key", "value")
            KEY_FIELD_NUMBER: _ClassVar[int]
            VALUE_FIELD_NUMBER: _ClassVar[int]
            key: str
            value: str
            def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
        class VersionsEntry(_message.Message):
            __slots__ = ("key", "value")
            KEY_FIELD_NUMBER: _ClassVar[int]
            VALUE_FIELD_NUMBER: _ClassVar[int]
            key: str
            value: str
            def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
        EPISODE_FIELD_NUMBER: _ClassVar[int]
        WALL_S_FIELD_NUMBER: _ClassVar[int]
        LANES_FIELD_NUMBER: _ClassVar[int]
        TRACES_FIELD_NUMBER: _ClassVar[int]
        VIEWS_FIELD_NUMBER: _ClassVar[int]
        CADENCE_FIELD_NUMBER: _ClassVar[int]
        VERSIONS_FIELD_NUMBER: _ClassVar[int]
        VERIFICATION_FIELD_NUMBER: _ClassVar[int]
        SIMULATED_FIELD_NUMBER: _ClassVar[int]
        VIEWPOINTS_FIELD_NUMBER: _ClassVar[int]
        episode: RecordedEpisode
        wall_s: float
        lanes: _containers.RepeatedCompositeFieldContainer[Lane]
        traces: _containers.RepeatedCompositeFieldContainer[Trace]
        views: _containers.RepeatedCompositeFieldContainer[RecordedView]
        cadence: _containers.ScalarMap[str, str]
        versions: _containers.ScalarMap[str, str]
        verification: str
        simulated: bool
        viewpoints: _containers.RepeatedScalarFieldContainer[str]
        def __init__(self, episode: _Optional[_Union[RecordedEpisode, _Mapping]] = ..., wall_s: _Optional[float] = ..., lanes: _Optional[_Iterable[_Union[Lane, _Mapping]]] = ..., traces: _Optional[_Iterable[_Union[Trace, _Mapping]]] = ..., views: _Optional[_Iterable[_Union[RecordedView, _Mapping]]] = ..., cadence: _Optional[_Mapping[str, str]] = ..., versions: _Optional[_Mapping[str, str]] = ..., verification: _Optional[str] = ..., simulated: _Optional[bool] = ..., viewpoints: _Optional[_Iterable[str]] = ...) -> None: ...
    class Piece(_message.Message):
        __slots__ = ("piece", "size_bytes", "pending", "sha256")
        PIECE_FIELD_NUMBER: _ClassVar[int]
        SIZE_BYTES_FIELD_NUMBER: _ClassVar[int]
        PENDING_FIELD_NUMBER: _ClassVar[int]
        SHA256_FIELD_NUMBER: _ClassVar[int]
        piece: bytes
        size_bytes: int
        pending: bool
        sha256: str
        def __init__(self, piece: _Optional[bytes] = ..., size_bytes: _Optional[int] = ..., pending: _Optional[bool] = ..., sha256: _Optional[str] = ...) -> None: ...
    class Curated(_message.Message):
        __slots__ = ("dataset", "changed", "left_out", "episodes", "act_ns")
        class LeftOutEntry(_message.Message):
            __slots__ = ("key", "value")
            KEY_FIELD_NUMBER: _ClassVar[int]
            VALUE_FIELD_NUMBER: _ClassVar[int]
            key: str
            value: int
            def __init__(self, key: _Optional[str] = ..., value: _Optional[int] = ...) -> None: ...
        DATASET_FIELD_NUMBER: _ClassVar[int]
        CHANGED_FIELD_NUMBER: _ClassVar[int]
        LEFT_OUT_FIELD_NUMBER: _ClassVar[int]
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        ACT_NS_FIELD_NUMBER: _ClassVar[int]
        dataset: str
        changed: int
        left_out: _containers.ScalarMap[str, int]
        episodes: int
        act_ns: int
        def __init__(self, dataset: _Optional[str] = ..., changed: _Optional[int] = ..., left_out: _Optional[_Mapping[str, int]] = ..., episodes: _Optional[int] = ..., act_ns: _Optional[int] = ...) -> None: ...
    ERROR_FIELD_NUMBER: _ClassVar[int]
    LISTING_FIELD_NUMBER: _ClassVar[int]
    DETAILS_FIELD_NUMBER: _ClassVar[int]
    EPISODE_FIELD_NUMBER: _ClassVar[int]
    PIECE_FIELD_NUMBER: _ClassVar[int]
    CURATED_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    listing: CatalogueReply.Listing
    details: CatalogueReply.Details
    episode: RecordedEpisode
    piece: CatalogueReply.Piece
    curated: CatalogueReply.Curated
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., listing: _Optional[_Union[CatalogueReply.Listing, _Mapping]] = ..., details: _Optional[_Union[CatalogueReply.Details, _Mapping]] = ..., episode: _Optional[_Union[RecordedEpisode, _Mapping]] = ..., piece: _Optional[_Union[CatalogueReply.Piece, _Mapping]] = ..., curated: _Optional[_Union[CatalogueReply.Curated, _Mapping]] = ...) -> None: ...
