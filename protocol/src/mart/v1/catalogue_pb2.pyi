from mart.v1 import room_pb2 as _room_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RecordedEpisode(_message.Message):
    __slots__ = ("path", "size_bytes", "room", "number", "task", "control_hz", "outcome", "verdict", "reason", "ticks", "simulated_s", "mode", "skill", "real_time_factor", "missing_ticks", "waited_s", "started_ns", "complete", "repaired", "interrupted", "operators", "error", "note", "dropped", "datasets", "missing_commands", "ended_by", "ended_by_name", "ended_by_arm", "subtasks_done", "subtasks", "outcome_by", "verification_pending", "outliers", "kept_ticks", "segments")
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
    OUTLIERS_FIELD_NUMBER: _ClassVar[int]
    KEPT_TICKS_FIELD_NUMBER: _ClassVar[int]
    SEGMENTS_FIELD_NUMBER: _ClassVar[int]
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
    outliers: _containers.RepeatedScalarFieldContainer[str]
    kept_ticks: int
    segments: int
    def __init__(self, path: _Optional[str] = ..., size_bytes: _Optional[int] = ..., room: _Optional[str] = ..., number: _Optional[int] = ..., task: _Optional[str] = ..., control_hz: _Optional[float] = ..., outcome: _Optional[str] = ..., verdict: _Optional[str] = ..., reason: _Optional[str] = ..., ticks: _Optional[int] = ..., simulated_s: _Optional[float] = ..., mode: _Optional[str] = ..., skill: _Optional[str] = ..., real_time_factor: _Optional[float] = ..., missing_ticks: _Optional[int] = ..., waited_s: _Optional[float] = ..., started_ns: _Optional[int] = ..., complete: _Optional[bool] = ..., repaired: _Optional[bool] = ..., interrupted: _Optional[bool] = ..., operators: _Optional[_Mapping[str, str]] = ..., error: _Optional[str] = ..., note: _Optional[str] = ..., dropped: _Optional[bool] = ..., datasets: _Optional[_Iterable[str]] = ..., missing_commands: _Optional[int] = ..., ended_by: _Optional[str] = ..., ended_by_name: _Optional[str] = ..., ended_by_arm: _Optional[str] = ..., subtasks_done: _Optional[int] = ..., subtasks: _Optional[int] = ..., outcome_by: _Optional[str] = ..., verification_pending: _Optional[bool] = ..., outliers: _Optional[_Iterable[str]] = ..., kept_ticks: _Optional[int] = ..., segments: _Optional[int] = ...) -> None: ...

class Edit(_message.Message):
    __slots__ = ("kind", "value")
    KIND_FIELD_NUMBER: _ClassVar[int]
    VALUE_FIELD_NUMBER: _ClassVar[int]
    kind: str
    value: str
    def __init__(self, kind: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...

class EditAct(_message.Message):
    __slots__ = ("act_ns", "by", "edits")
    ACT_NS_FIELD_NUMBER: _ClassVar[int]
    BY_FIELD_NUMBER: _ClassVar[int]
    EDITS_FIELD_NUMBER: _ClassVar[int]
    act_ns: int
    by: str
    edits: _containers.RepeatedCompositeFieldContainer[Edit]
    def __init__(self, act_ns: _Optional[int] = ..., by: _Optional[str] = ..., edits: _Optional[_Iterable[_Union[Edit, _Mapping]]] = ...) -> None: ...

class TickRange(_message.Message):
    __slots__ = ("begin", "end")
    BEGIN_FIELD_NUMBER: _ClassVar[int]
    END_FIELD_NUMBER: _ClassVar[int]
    begin: int
    end: int
    def __init__(self, begin: _Optional[int] = ..., end: _Optional[int] = ...) -> None: ...

class EpisodeEdits(_message.Message):
    __slots__ = ("cuts", "skips", "splits", "subtasks", "kept_ticks", "segments", "acts")
    class SubtasksEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: int
        def __init__(self, key: _Optional[str] = ..., value: _Optional[int] = ...) -> None: ...
    CUTS_FIELD_NUMBER: _ClassVar[int]
    SKIPS_FIELD_NUMBER: _ClassVar[int]
    SPLITS_FIELD_NUMBER: _ClassVar[int]
    SUBTASKS_FIELD_NUMBER: _ClassVar[int]
    KEPT_TICKS_FIELD_NUMBER: _ClassVar[int]
    SEGMENTS_FIELD_NUMBER: _ClassVar[int]
    ACTS_FIELD_NUMBER: _ClassVar[int]
    cuts: _containers.RepeatedCompositeFieldContainer[TickRange]
    skips: _containers.RepeatedCompositeFieldContainer[TickRange]
    splits: _containers.RepeatedScalarFieldContainer[int]
    subtasks: _containers.ScalarMap[str, int]
    kept_ticks: int
    segments: int
    acts: _containers.RepeatedCompositeFieldContainer[EditAct]
    def __init__(self, cuts: _Optional[_Iterable[_Union[TickRange, _Mapping]]] = ..., skips: _Optional[_Iterable[_Union[TickRange, _Mapping]]] = ..., splits: _Optional[_Iterable[int]] = ..., subtasks: _Optional[_Mapping[str, int]] = ..., kept_ticks: _Optional[int] = ..., segments: _Optional[int] = ..., acts: _Optional[_Iterable[_Union[EditAct, _Mapping]]] = ...) -> None: ...

class TickTimes(_message.Message):
    __slots__ = ("ticks", "seconds")
    TICKS_FIELD_NUMBER: _ClassVar[int]
    SECONDS_FIELD_NUMBER: _ClassVar[int]
    ticks: _containers.RepeatedScalarFieldContainer[int]
    seconds: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, ticks: _Optional[_Iterable[int]] = ..., seconds: _Optional[_Iterable[float]] = ...) -> None: ...

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

class QualityNumber(_message.Message):
    __slots__ = ("name", "arm", "title", "unit", "value", "low", "high", "median", "outlier")
    NAME_FIELD_NUMBER: _ClassVar[int]
    ARM_FIELD_NUMBER: _ClassVar[int]
    TITLE_FIELD_NUMBER: _ClassVar[int]
    UNIT_FIELD_NUMBER: _ClassVar[int]
    VALUE_FIELD_NUMBER: _ClassVar[int]
    LOW_FIELD_NUMBER: _ClassVar[int]
    HIGH_FIELD_NUMBER: _ClassVar[int]
    MEDIAN_FIELD_NUMBER: _ClassVar[int]
    OUTLIER_FIELD_NUMBER: _ClassVar[int]
    name: str
    arm: str
    title: str
    unit: str
    value: float
    low: float
    high: float
    median: float
    outlier: str
    def __init__(self, name: _Optional[str] = ..., arm: _Optional[str] = ..., title: _Optional[str] = ..., unit: _Optional[str] = ..., value: _Optional[float] = ..., low: _Optional[float] = ..., high: _Optional[float] = ..., median: _Optional[float] = ..., outlier: _Optional[str] = ...) -> None: ...

class QualityGroup(_message.Message):
    __slots__ = ("name", "episodes", "successes", "outliers", "numbers")
    NAME_FIELD_NUMBER: _ClassVar[int]
    EPISODES_FIELD_NUMBER: _ClassVar[int]
    SUCCESSES_FIELD_NUMBER: _ClassVar[int]
    OUTLIERS_FIELD_NUMBER: _ClassVar[int]
    NUMBERS_FIELD_NUMBER: _ClassVar[int]
    name: str
    episodes: int
    successes: int
    outliers: int
    numbers: _containers.RepeatedCompositeFieldContainer[QualityNumber]
    def __init__(self, name: _Optional[str] = ..., episodes: _Optional[int] = ..., successes: _Optional[int] = ..., outliers: _Optional[int] = ..., numbers: _Optional[_Iterable[_Union[QualityNumber, _Mapping]]] = ...) -> None: ...

class CatalogueRequest(_message.Message):
    __slots__ = ("list", "show", "label", "file", "video", "picture", "curate", "undo", "compare_quality", "show_quality", "edit", "undo_edit", "scene", "motion")
    class List(_message.Message):
        __slots__ = ("task", "outcome", "verdict", "operator", "room", "offset", "count", "skill", "dataset", "since_ns", "outliers")
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
        OUTLIERS_FIELD_NUMBER: _ClassVar[int]
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
        outliers: bool
        def __init__(self, task: _Optional[str] = ..., outcome: _Optional[str] = ..., verdict: _Optional[str] = ..., operator: _Optional[str] = ..., room: _Optional[str] = ..., offset: _Optional[int] = ..., count: _Optional[int] = ..., skill: _Optional[str] = ..., dataset: _Optional[str] = ..., since_ns: _Optional[int] = ..., outliers: _Optional[bool] = ...) -> None: ...
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
    class CompareQuality(_message.Message):
        __slots__ = ("task", "by")
        TASK_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        task: str
        by: str
        def __init__(self, task: _Optional[str] = ..., by: _Optional[str] = ...) -> None: ...
    class ShowQuality(_message.Message):
        __slots__ = ("path",)
        PATH_FIELD_NUMBER: _ClassVar[int]
        path: str
        def __init__(self, path: _Optional[str] = ...) -> None: ...
    class Undo(_message.Message):
        __slots__ = ("dataset", "act_ns", "by")
        DATASET_FIELD_NUMBER: _ClassVar[int]
        ACT_NS_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        dataset: str
        act_ns: int
        by: str
        def __init__(self, dataset: _Optional[str] = ..., act_ns: _Optional[int] = ..., by: _Optional[str] = ...) -> None: ...
    class EditEpisode(_message.Message):
        __slots__ = ("path", "edits", "skip_idle_s", "by")
        PATH_FIELD_NUMBER: _ClassVar[int]
        EDITS_FIELD_NUMBER: _ClassVar[int]
        SKIP_IDLE_S_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        path: str
        edits: _containers.RepeatedCompositeFieldContainer[Edit]
        skip_idle_s: float
        by: str
        def __init__(self, path: _Optional[str] = ..., edits: _Optional[_Iterable[_Union[Edit, _Mapping]]] = ..., skip_idle_s: _Optional[float] = ..., by: _Optional[str] = ...) -> None: ...
    class UndoEdit(_message.Message):
        __slots__ = ("path", "act_ns", "by")
        PATH_FIELD_NUMBER: _ClassVar[int]
        ACT_NS_FIELD_NUMBER: _ClassVar[int]
        BY_FIELD_NUMBER: _ClassVar[int]
        path: str
        act_ns: int
        by: str
        def __init__(self, path: _Optional[str] = ..., act_ns: _Optional[int] = ..., by: _Optional[str] = ...) -> None: ...
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
    COMPARE_QUALITY_FIELD_NUMBER: _ClassVar[int]
    SHOW_QUALITY_FIELD_NUMBER: _ClassVar[int]
    EDIT_FIELD_NUMBER: _ClassVar[int]
    UNDO_EDIT_FIELD_NUMBER: _ClassVar[int]
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
    compare_quality: CatalogueRequest.CompareQuality
    show_quality: CatalogueRequest.ShowQuality
    edit: CatalogueRequest.EditEpisode
    undo_edit: CatalogueRequest.UndoEdit
    scene: CatalogueRequest.Scene
    motion: CatalogueRequest.Motion
    def __init__(self, list: _Optional[_Union[CatalogueRequest.List, _Mapping]] = ..., show: _Optional[_Union[CatalogueRequest.Show, _Mapping]] = ..., label: _Optional[_Union[CatalogueRequest.Label, _Mapping]] = ..., file: _Optional[_Union[CatalogueRequest.File, _Mapping]] = ..., video: _Optional[_Union[CatalogueRequest.Video, _Mapping]] = ..., picture: _Optional[_Union[CatalogueRequest.Picture, _Mapping]] = ..., curate: _Optional[_Union[CatalogueRequest.Curate, _Mapping]] = ..., undo: _Optional[_Union[CatalogueRequest.Undo, _Mapping]] = ..., compare_quality: _Optional[_Union[CatalogueRequest.CompareQuality, _Mapping]] = ..., show_quality: _Optional[_Union[CatalogueRequest.ShowQuality, _Mapping]] = ..., edit: _Optional[_Union[CatalogueRequest.EditEpisode, _Mapping]] = ..., undo_edit: _Optional[_Union[CatalogueRequest.UndoEdit, _Mapping]] = ..., scene: _Optional[_Union[CatalogueRequest.Scene, _Mapping]] = ..., motion: _Optional[_Union[CatalogueRequest.Motion, _Mapping]] = ...) -> None: ...

class CatalogueReply(_message.Message):
    __slots__ = ("error", "listing", "details", "episode", "piece", "curated", "quality_comparison", "quality_details", "edited")
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
        __slots__ = ("episodes", "matching", "successes", "tasks", "operators", "datasets", "skills", "simulated_s", "drivers", "files_read", "files_to_read")
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        MATCHING_FIELD_NUMBER: _ClassVar[int]
        SUCCESSES_FIELD_NUMBER: _ClassVar[int]
        TASKS_FIELD_NUMBER: _ClassVar[int]
        OPERATORS_FIELD_NUMBER: _ClassVar[int]
        DATASETS_FIELD_NUMBER: _ClassVar[int]
        SKILLS_FIELD_NUMBER: _ClassVar[int]
        SIMULATED_S_FIELD_NUMBER: _ClassVar[int]
        DRIVERS_FIELD_NUMBER: _ClassVar[int]
        FILES_READ_FIELD_NUMBER: _ClassVar[int]
        FILES_TO_READ_FIELD_NUMBER: _ClassVar[int]
        episodes: _containers.RepeatedCompositeFieldContainer[RecordedEpisode]
        matching: int
        successes: int
        tasks: _containers.RepeatedScalarFieldContainer[str]
        operators: _containers.RepeatedScalarFieldContainer[str]
        datasets: _containers.RepeatedCompositeFieldContainer[NamedDataSet]
        skills: _containers.RepeatedScalarFieldContainer[str]
        simulated_s: float
        drivers: _containers.RepeatedCompositeFieldContainer[CatalogueReply.DriverStatistics]
        files_read: int
        files_to_read: int
        def __init__(self, episodes: _Optional[_Iterable[_Union[RecordedEpisode, _Mapping]]] = ..., matching: _Optional[int] = ..., successes: _Optional[int] = ..., tasks: _Optional[_Iterable[str]] = ..., operators: _Optional[_Iterable[str]] = ..., datasets: _Optional[_Iterable[_Union[NamedDataSet, _Mapping]]] = ..., skills: _Optional[_Iterable[str]] = ..., simulated_s: _Optional[float] = ..., drivers: _Optional[_Iterable[_Union[CatalogueReply.DriverStatistics, _Mapping]]] = ..., files_read: _Optional[int] = ..., files_to_read: _Optional[int] = ...) -> None: ...
    class Details(_message.Message):
        __slots__ = ("episode", "wall_s", "lanes", "traces", "views", "cadence", "versions", "verification", "simulated", "viewpoints", "edits", "tick_times")
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
        EDITS_FIELD_NUMBER: _ClassVar[int]
        TICK_TIMES_FIELD_NUMBER: _ClassVar[int]
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
        edits: EpisodeEdits
        tick_times: TickTimes
        def __init__(self, episode: _Optional[_Union[RecordedEpisode, _Mapping]] = ..., wall_s: _Optional[float] = ..., lanes: _Optional[_Iterable[_Union[Lane, _Mapping]]] = ..., traces: _Optional[_Iterable[_Union[Trace, _Mapping]]] = ..., views: _Optional[_Iterable[_Union[RecordedView, _Mapping]]] = ..., cadence: _Optional[_Mapping[str, str]] = ..., versions: _Optional[_Mapping[str, str]] = ..., verification: _Optional[str] = ..., simulated: _Optional[bool] = ..., viewpoints: _Optional[_Iterable[str]] = ..., edits: _Optional[_Union[EpisodeEdits, _Mapping]] = ..., tick_times: _Optional[_Union[TickTimes, _Mapping]] = ...) -> None: ...
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
    class Edited(_message.Message):
        __slots__ = ("episode", "edits", "act_ns")
        EPISODE_FIELD_NUMBER: _ClassVar[int]
        EDITS_FIELD_NUMBER: _ClassVar[int]
        ACT_NS_FIELD_NUMBER: _ClassVar[int]
        episode: RecordedEpisode
        edits: EpisodeEdits
        act_ns: int
        def __init__(self, episode: _Optional[_Union[RecordedEpisode, _Mapping]] = ..., edits: _Optional[_Union[EpisodeEdits, _Mapping]] = ..., act_ns: _Optional[int] = ...) -> None: ...
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
    class QualityDetails(_message.Message):
        __slots__ = ("numbers", "episodes", "pending", "error")
        NUMBERS_FIELD_NUMBER: _ClassVar[int]
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        PENDING_FIELD_NUMBER: _ClassVar[int]
        ERROR_FIELD_NUMBER: _ClassVar[int]
        numbers: _containers.RepeatedCompositeFieldContainer[QualityNumber]
        episodes: int
        pending: bool
        error: str
        def __init__(self, numbers: _Optional[_Iterable[_Union[QualityNumber, _Mapping]]] = ..., episodes: _Optional[int] = ..., pending: _Optional[bool] = ..., error: _Optional[str] = ...) -> None: ...
    class QualityComparison(_message.Message):
        __slots__ = ("groups", "measured", "episodes", "outliers")
        GROUPS_FIELD_NUMBER: _ClassVar[int]
        MEASURED_FIELD_NUMBER: _ClassVar[int]
        EPISODES_FIELD_NUMBER: _ClassVar[int]
        OUTLIERS_FIELD_NUMBER: _ClassVar[int]
        groups: _containers.RepeatedCompositeFieldContainer[QualityGroup]
        measured: int
        episodes: int
        outliers: _containers.RepeatedCompositeFieldContainer[RecordedEpisode]
        def __init__(self, groups: _Optional[_Iterable[_Union[QualityGroup, _Mapping]]] = ..., measured: _Optional[int] = ..., episodes: _Optional[int] = ..., outliers: _Optional[_Iterable[_Union[RecordedEpisode, _Mapping]]] = ...) -> None: ...
    ERROR_FIELD_NUMBER: _ClassVar[int]
    LISTING_FIELD_NUMBER: _ClassVar[int]
    DETAILS_FIELD_NUMBER: _ClassVar[int]
    EPISODE_FIELD_NUMBER: _ClassVar[int]
    PIECE_FIELD_NUMBER: _ClassVar[int]
    CURATED_FIELD_NUMBER: _ClassVar[int]
    QUALITY_COMPARISON_FIELD_NUMBER: _ClassVar[int]
    QUALITY_DETAILS_FIELD_NUMBER: _ClassVar[int]
    EDITED_FIELD_NUMBER: _ClassVar[int]
    error: _room_pb2.Error
    listing: CatalogueReply.Listing
    details: CatalogueReply.Details
    episode: RecordedEpisode
    piece: CatalogueReply.Piece
    curated: CatalogueReply.Curated
    quality_comparison: CatalogueReply.QualityComparison
    quality_details: CatalogueReply.QualityDetails
    edited: CatalogueReply.Edited
    def __init__(self, error: _Optional[_Union[_room_pb2.Error, _Mapping]] = ..., listing: _Optional[_Union[CatalogueReply.Listing, _Mapping]] = ..., details: _Optional[_Union[CatalogueReply.Details, _Mapping]] = ..., episode: _Optional[_Union[RecordedEpisode, _Mapping]] = ..., piece: _Optional[_Union[CatalogueReply.Piece, _Mapping]] = ..., curated: _Optional[_Union[CatalogueReply.Curated, _Mapping]] = ..., quality_comparison: _Optional[_Union[CatalogueReply.QualityComparison, _Mapping]] = ..., quality_details: _Optional[_Union[CatalogueReply.QualityDetails, _Mapping]] = ..., edited: _Optional[_Union[CatalogueReply.Edited, _Mapping]] = ...) -> None: ...
