// The HTTP API and the live socket as docs/protocol.md describes them, section 2; what is protobuf there is Messages.

declare namespace Api {
  interface Person {
    holder_id: string;
    name: string;
    hosts: boolean;
    passed_course: boolean;
  }

  interface TaskOption {
    name: string;
    title: string;
    instruction: string;
    arms: number;
    arm_counts: number[];
    arm_kinds: string[];
  }

  interface ArmKind {
    name: string;
    title: string;
  }

  /** What an arm holds at its end: said after its kind and a plus sign. */
  interface EndEffector {
    name: string;
    title: string;
    about: string;
  }

  interface RoomOptions {
    tasks: TaskOption[];
    arm_kinds: ArmKind[];
    end_effectors: EndEffector[];
    opens_rooms: boolean;
  }

  interface NewRoom {
    task: string;
    room: string;
    control_hz: number;
    episodes: number;
    arms: number;
    practice: boolean;
    course_required: boolean;
    /** By arm, of those that are no Pandas. */
    arm_kinds?: Record<string, string>;
  }

  interface Finding {
    area: "services" | "rooms" | "delays" | "machine";
    name: string;
    found: string;
    mend: string;
  }

  interface Invitation {
    url: string;
    other_urls: string[];
    code: string;
    qr_svg: string;
    watch_url: string;
    hint: string;
  }

  interface ServerTime {
    unix_s: number;
    certificate_days: number | null;
  }

  // Rooms

  interface Seat {
    arm: string;
    operator: Messages.Operator;
    epoch: number;
    holder_id: string;
    name: string;
    ready: boolean;
    engaged: boolean;
    mine: boolean;
    policy: string;
    relieved: string;
    kept_s: number;
    passed_course: boolean;
  }

  interface Waiting {
    arm: string;
    name: string;
    since_s: number;
  }

  interface RoomEpisode {
    number: number;
    phase: Messages.EpisodePhase;
    remaining_s: number;
    ticks: number;
    elapsed_s: number;
    outcome: Messages.Outcome | "unspecified";
    reason: string;
    ended_by: string;
    ended_by_name: string;
    ended_by_arm: string;
  }

  interface Subtask {
    name: string;
    title: string;
    arms: string[];
    done: boolean;
    /** Simulated, and 0 where the task keeps no score. */
    seconds: number;
    tries: number;
  }

  interface Plan {
    episodes: number;
    good: number;
  }

  interface SavedFile {
    path: string;
    verified: boolean;
    verdict: string;
    size_bytes: number;
    outcome: Messages.Outcome | "unspecified";
  }

  interface LastEpisode {
    number: number;
    outcome: Messages.Outcome | "unspecified";
    reason: string;
    ended_by: string;
    subtasks_done: number;
    subtasks: number;
    since_s: number;
    epochs: Record<string, number>;
    saved: SavedFile | null;
  }

  interface Room {
    room: string;
    task: string;
    title: string;
    instruction: string;
    time_limit_s: number | null;
    stale: boolean;
    slow: boolean;
    control_hz: number;
    tick: number;
    real_time_factor: number;
    barrier: Messages.BarrierPhase;
    waiting_for: Waiting[];
    seats: Seat[];
    /** Real ones; `arm` is empty where every seat may show it, `dark` where it gives pictures. */
    cameras: { camera: string; arm: string; dark: string }[];
    /** By arm. */
    to_do: Record<string, string>;
    episode: RoomEpisode;
    progress: { subtasks: Subtask[]; success: boolean; failed: boolean };
    episodes_saved: number;
    episodes_good: number;
    plan: Plan | null;
    stop: { arm: string; name: string; by_host: boolean; also_name: string; fault: string } | null;
    unrecorded: string;
    practice: boolean;
    course_required: boolean;
    /** One for each seat; none: all are Pandas. */
    arm_kinds: string[];
    still: number;
    /** By arm, of those from whose side somebody looks. */
    stills: Record<string, number>;
    last_episode: LastEpisode | null;
  }

  type EpisodeAction = "ready" | "unready" | "success" | "failure" | "discard" | "reset";

  interface Notice {
    id: number;
    room: string;
    kind: "notice";
    level: string;
    text: string;
    from: string;
  }

  interface CueGiven {
    id: number;
    room: string;
    kind: "cue_given";
    arm: string;
    cue: Messages.Cue;
  }

  interface EpisodeSaved extends SavedFile {
    id: number;
    room: string;
    kind: "episode_saved";
    number: number;
  }

  type RoomEvent = Notice | CueGiven | EpisodeSaved;

  interface LiveMessage {
    rooms?: Room[];
    event?: RoomEvent;
  }

  // Peers

  type PeerRole = "browser" | "viewer" | "phone";

  interface SeatToken {
    token: string;
    role: PeerRole;
    epoch: number;
    speaks_as: string;
    ice_servers: RTCIceServer[];
  }

  interface Pairing {
    code: string;
    url: string;
    expires_s: number;
    qr_svg: string;
    hint: string;
  }

  interface PairedPhone extends SeatToken {
    room: string;
    arm: string;
    name: string;
  }

  // Recorded episodes

  interface Episode extends Omit<Messages.RecordedEpisode, "real_time_factor"> {
    title: string;
    started_ms: number;
    real_time_factor: number | null;
  }

  interface EpisodeListing extends Omit<Messages.CatalogueReplyListing, "episodes" | "tasks"> {
    episodes: Episode[];
    tasks: Record<string, string>;
  }

  type LaneKind = "subtask" | "driver" | "engaged" | "waiting" | "lost" | "cue" | "notice";

  interface Lane extends Messages.Lane {
    kind: LaneKind;
    title: string;
  }

  interface EpisodeDetails extends Omit<Messages.CatalogueReplyDetails, "episode" | "lanes" | "edits" | "tick_times"> {
    episode: Episode;
    edits: Messages.EpisodeEdits;
    tick_times: Messages.TickTimes;
    lanes: Lane[];
  }

  interface EditedEpisode extends Omit<Messages.CatalogueReplyEdited, "episode" | "edits"> {
    episode: Episode;
    edits: Messages.EpisodeEdits;
  }

  interface EpisodeEditing {
    edits?: { kind: "cut" | "skip" | "split" | "subtask"; value: string }[];
    skip_idle_s?: number;
  }

  interface EpisodeLabels {
    outcome?: Messages.Outcome;
    note?: string;
    dropped?: boolean;
  }

  interface EpisodeFilter {
    task?: string;
    outcome?: string;
    verdict?: string;
    operator?: string;
    room?: string;
    skill?: string;
    dataset?: string;
    outliers?: string;
  }

  interface QualityComparison extends Omit<Messages.CatalogueReplyQualityComparison, "outliers"> {
    outliers: Episode[];
  }

  type Curation = { action: "add" | "remove" } & ({ paths: string[] } | { all: EpisodeFilter });

  // Training

  interface TrainingOrder extends Omit<Messages.Order, "model" | "task" | "score_episodes" | "control_hz" | "skip_idle_s"> {
    models: string[];
    tasks: string[];
    score_episodes: number | undefined;
    executor: string;
  }

  interface TrainingChoices extends Messages.TrainerReplyChoices {
    order: Messages.Order;
  }

  interface Job extends Messages.Job {
    order: Messages.Order;
  }

  interface JobDetails extends Messages.TrainerReplyDetails {
    job: Job;
  }

  interface Promotion {
    job: string;
    checkpoint: string;
    name: string;
  }
}
