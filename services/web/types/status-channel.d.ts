// The status channel between a gateway and its peers: docs/protocol.md, section "Status channel".

declare namespace StatusChannel {
  type Input = "keyboard" | "phone";

  type LetGo = "" | "new" | "tracking" | "gap" | "jump" | "age" | "picture" | "stop" | "pause";

  interface Latency {
    p50_ms: number;
    p95_ms: number;
    stages: Record<string, number>;
  }

  interface Tick {
    type: "tick";
    tick: number;
    sequence: number;
    rtf: number;
    engaged: boolean;
    let_go: LetGo;
    /** null where the arm has no fingers: whatever is said of its gripper counts for nothing. */
    gripper: number | null;
    gripper_set: number;
    holding: boolean;
    hand_scale: number;
    barrier: Messages.BarrierPhase;
    phase: Messages.EpisodePhase | "unspecified";
    ready: boolean;
    practises_only: boolean;
    partners: boolean;
    others: boolean;
    stopped_by: string;
    paused_by_host: boolean;
    waiting: { arm: string; since_s: number }[];
    input: Input;
    phone: { age_ms: number; tracking: boolean; started: boolean } | null;
    rejected: Record<string, number>;
    no_picture: string;
    /** The real camera that the seat shows; absent where its picture is drawn. */
    camera?: string;
    /** Thousandths of the picture's width and height, from its upper left corner. */
    tools: Record<string, [right: number, down: number]>;
    /** While the arm follows a hand. */
    view?: ToolView;
    fps: number;
    latency: Latency | null;
  }

  /**
   * One's own tool, seen from a level frame at the camera: x to the picture's right, y up, z towards the person; metres.
   * `table`: how high the table is; `focal`: picture heights that a metre takes at a metre's distance.
   */
  interface ToolView {
    tool: [x: number, y: number, z: number];
    table: number;
    camera: [w: number, x: number, y: number, z: number];
    focal: number;
  }

  interface Pong {
    type: "pong";
    t_us: number;
    gateway_ns: number;
    picture_kbit_s?: number;
  }

  interface Replaced {
    type: "replaced";
  }

  /** `arm` is empty for a host. */
  interface Speaker {
    arm: string;
    name: string;
  }

  interface Voices {
    type: "voices";
    speakers: Speaker[];
    heard: boolean;
  }

  /** `name` is empty for a machine without one; `number` is greater for what is said later. */
  interface SaidCue {
    arm: string;
    name: string;
    cue: string;
    number: number;
  }

  interface Cues {
    type: "cues";
    said: SaidCue[];
  }

  interface CueRefused {
    type: "cue_refused";
    cue: string;
    t_us: number;
  }

  type FromGateway = Tick | Pong | Replaced | Voices | Cues | CueRefused;

  type ToGateway =
    | { type: "ping"; t_us: number }
    | { type: "clock"; offset_ns: number }
    | { type: "seen"; tick: number; t_us: number }
    | { type: "drawing"; on: boolean; p50_ms: number; p95_ms: number; per_s: number }
    | { type: "input"; input: Input }
    | { type: "camera"; camera: string }
    | { type: "token"; token: string }
    | { type: "cue"; cue: Messages.Cue; t_us: number };
}
