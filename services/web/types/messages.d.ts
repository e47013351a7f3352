// Protobuf messages as the API sends them (docs/protocol.md): 64-bit numbers as text, enums in one word.
// Made by `make page-facts` from the Python parts; do not edit.

declare namespace Messages {
  type BarrierPhase = "running" | "stalled" | "paused" | "stopped";
  type Cue = "have_it" | "go" | "wait" | "slower" | "thanks" | "let_go" | "come_closer";
  type EpisodePhase = "practice" | "countdown" | "recording" | "ended";
  type JobState = "queued" | "running" | "done" | "failed" | "cancelled";
  type Operator = "hold" | "human" | "policy" | "script" | "generated";
  type Outcome = "success" | "failure" | "discarded";

  interface CatalogueReplyCurated {
    dataset: string;
    changed: number;
    left_out: Record<string, number>;
    episodes: number;
    act_ns: string;
  }

  interface CatalogueReplyDetails {
    episode?: RecordedEpisode;
    wall_s: number;
    lanes: Lane[];
    traces: Trace[];
    views: RecordedView[];
    cadence: Record<string, string>;
    versions: Record<string, string>;
    verification: string;
    simulated: boolean;
    viewpoints: string[];
    edits?: EpisodeEdits;
    tick_times?: TickTimes;
  }

  interface CatalogueReplyDriverStatistics {
    name: string;
    episodes: number;
    successes: number;
    simulated_s: number;
  }

  interface CatalogueReplyEdited {
    episode?: RecordedEpisode;
    edits?: EpisodeEdits;
    act_ns: string;
  }

  interface CatalogueReplyListing {
    episodes: RecordedEpisode[];
    matching: number;
    successes: number;
    tasks: string[];
    operators: string[];
    datasets: NamedDataSet[];
    skills: string[];
    simulated_s: number;
    drivers: CatalogueReplyDriverStatistics[];
    files_read: number;
    files_to_read: number;
  }

  interface CatalogueReplyQualityComparison {
    groups: QualityGroup[];
    measured: number;
    episodes: number;
    outliers: RecordedEpisode[];
  }

  interface CatalogueReplyQualityDetails {
    numbers: QualityNumber[];
    episodes: number;
    pending: boolean;
    error: string;
  }

  interface Curve {
    name: string;
    updates: number[];
    values: number[];
  }

  interface DataSet {
    path: string;
    episodes: number;
    tasks: string[];
    name: string;
    left_out: number;
    sha256: string;
  }

  interface Edit {
    kind: string;
    value: string;
  }

  interface EditAct {
    act_ns: string;
    by: string;
    edits: Edit[];
  }

  interface EpisodeEdits {
    cuts: TickRange[];
    skips: TickRange[];
    splits: number[];
    subtasks: Record<string, string>;
    kept_ticks: number;
    segments: number;
    acts: EditAct[];
  }

  interface Evaluation {
    seed: number;
    updates: number;
    checkpoint: string;
    purpose: string;
    episodes: number;
    successes: number;
    low: number;
    high: number;
    mean_success_time_s: number;
    done: SubtaskCount[];
    failures: SubtaskCount[];
    rollouts: Rollout[];
  }

  interface Job {
    id: string;
    sweep: string;
    order?: Order;
    state: JobState;
    executor: string;
    submitted_ns: string;
    started_ns: string;
    ended_ns: string;
    attempt: number;
    detail: string;
    run: string;
    progress?: JobProgress;
  }

  interface JobProgress {
    updates: number;
    updates_in_all: number;
    updates_per_s: number;
    loss: number;
    best_success: number;
    stage: string;
  }

  interface Lane {
    kind: string;
    name: string;
    spans: Span[];
  }

  interface Learned {
    episodes: number;
    ticks: number;
    sha256: string;
    dataset: string;
    dataset_episodes: number;
    left_out: string[];
    control_hz: number;
  }

  interface NamedDataSet {
    name: string;
    episodes: number;
    sha256: string;
    created_ns: string;
  }

  interface Order {
    model: string;
    task: string;
    data: string;
    preset: string;
    seeds: number[];
    evaluation_episodes: number;
    score_episodes?: number;
    dataset: string;
    control_hz: number;
    skip_idle_s: number;
  }

  interface Policy {
    name: string;
    model: string;
    task: string;
    control_hz: number;
    arms: string[];
    joint: boolean;
    seed: number;
    updates: number;
    job: string;
    evaluation?: Evaluation;
    promoted_ns: string;
    arm_kinds: string[];
  }

  interface QualityGroup {
    name: string;
    episodes: number;
    successes: number;
    outliers: number;
    numbers: QualityNumber[];
  }

  interface QualityNumber {
    name: string;
    arm: string;
    title: string;
    unit: string;
    value: number;
    low?: number;
    high?: number;
    median?: number;
    outlier: string;
  }

  interface RecordedEpisode {
    path: string;
    size_bytes: string;
    room: string;
    number: number;
    task: string;
    control_hz: number;
    outcome: string;
    verdict: string;
    reason: string;
    ticks: number;
    simulated_s: number;
    mode: string;
    skill: string;
    real_time_factor?: number;
    missing_ticks: number;
    waited_s: number;
    started_ns: string;
    complete: boolean;
    repaired: boolean;
    interrupted: boolean;
    operators: Record<string, string>;
    error: string;
    note: string;
    dropped: boolean;
    datasets: string[];
    missing_commands?: number;
    ended_by: string;
    ended_by_name: string;
    ended_by_arm: string;
    subtasks_done?: number;
    subtasks?: number;
    outcome_by: string;
    verification_pending: boolean;
    outliers: string[];
    kept_ticks?: number;
    segments: number;
  }

  interface RecordedView {
    camera: string;
    start_s: number;
  }

  interface Rollout {
    name: string;
    seed: string;
    outcome: string;
    detail: string;
    time_s: number;
  }

  interface Span {
    begin_s: number;
    end_s: number;
    text: string;
  }

  interface SubtaskCount {
    name: string;
    episodes: number;
  }

  interface TickRange {
    begin: number;
    end: number;
  }

  interface TickTimes {
    ticks: number[];
    seconds: number[];
  }

  interface Trace {
    arm: string;
    quantity: string;
    unit: string;
    seconds: number[];
    values: number[];
  }

  interface TrainerReplyChoices {
    models: TrainerReplyChoicesModel[];
    tasks: string[];
    presets: string[];
    data: DataSet[];
    executors: string[];
    device: string;
    order?: Order;
  }

  interface TrainerReplyChoicesModel {
    name: string;
    planner: string;
    actor: string;
    residual: string;
    about: string;
  }

  interface TrainerReplyDetails {
    job?: Job;
    curves: Curve[];
    evaluations: Evaluation[];
    checkpoints: string[];
    learned?: Learned;
  }
}
