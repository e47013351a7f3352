// Made by `make page-facts` from the Python parts; do not edit.

/** The arms that a task may have. */
export const ARMS = /** @type {const} */ (["arm0", "arm1", "arm2", "arm3"]);

/** The shape that stands for each arm. */
export const ARM_SYMBOLS = /** @type {const} */ ({ arm0: "circle", arm1: "square", arm2: "triangle", arm3: "diamond" });

/** The tasks as people call them. */
export const TASK_TITLES = /** @type {const} */ ({
  practice_course: "Practice course",
  two_arm_drink_tray_lifting: "Drink tray lifting",
  two_arm_multi_cube_lifting: "Multi-cube lifting",
  two_arm_pick_place_handover: "Pick-place handover",
  two_arm_table_assembly: "Table assembly",
  three_arm_lift_wiping: "Lift and wipe",
});

/** What partners can say by one press, in the order of the keys. */
export const CUES = /** @type {const} */ (["have_it", "go", "wait", "slower", "thanks", "let_go", "come_closer"]);

/** ModelSpec architectures: who can plan, who can act, who can correct. */
export const MODEL_AXES = /** @type {const} */ ({
  planner: ["none", "joint", "per-arm"],
  actor: ["joint", "per-arm"],
  residual: ["none", "joint", "per-arm"],
});

/** The paper's models, in the order of its table. */
export const PAPER_MODELS = /** @type {const} */ (["BC-RNN", "HBC", "d-HBC", "dh-HBC", "dl-HBC", "r-HBC", "rd-HBC"]);

/** Sizes of a training, the smallest first. */
export const PRESETS = /** @type {const} */ (["debug", "fast", "paper"]);

/** Control rates that a room may have, ticks a second. */
export const CONTROL_RATES_HZ = /** @type {const} */ ([20, 30, 60]);

/** Good episodes that a room may plan at most. */
export const MAX_PLANNED_EPISODES = 10000;

/** Characters of a name of a room, at most. */
export const MAX_NAME_LENGTH = 64;

/** Characters of a note about an episode, at most. */
export const MAX_NOTE_LENGTH = 2000;

/** Seeds of a training, at most. */
export const MAX_SEEDS = 64;

/** Rollouts of a checkpoint, at most. */
export const MAX_ROLLOUTS = 1000;
