/* Operational-space control of seven-joint arms, run by MuJoCo inside every physics substep (`mjcb_control`).
 *
 * Khatib, "A unified approach for motion and force control of robot manipulators: the operational space
 * formulation", IEEE J. Robotics and Automation 3(1), 1987:
 *
 *   tau = J' Lambda (kp e - kd J qd - J a0) + M a0 + bias - passive,   Lambda = (J M^-1 J' + D)^-1
 *
 * with the full 6x6 Lambda (a block-diagonal one overshoots by 5 %), critical damping, and a0 the joint acceleration
 * that pulls towards the posture; what of it would move the tool is taken out by the `J a0` term. D grows near
 * singularities. Fingers count as locked. Everything is read from mjData at its current substep: no global, no lock,
 * so any number of worlds may run at once.
 *
 * The callback serves every model in the process, so it acts only on models whose first <custom><numeric> begins
 * with MAGIC. That numeric holds gains and indices; the arms' commands are in mjData.userdata, which is part of the
 * saved state. osc.py writes both and mirrors the layout below.
 */
#include <math.h>
#include <mujoco/mjdata.h>
#include <mujoco/mjmodel.h>
#include <mujoco/mujoco.h>

#define MAGIC 1296126548.0 /* "MART" in ASCII */
#define JOINTS 7

enum {  /* the numeric: a header, then one row for each arm */
  MAGIC_NUMBER, ARMS, KP_POSITION, KP_ORIENTATION, KP_POSTURE, MAX_POSITION_ERROR, MAX_ORIENTATION_ERROR,
  REGULAR_MOBILITY_POSITION, REGULAR_MOBILITY_ORIENTATION, HEADER_SIZE
};
enum { SITE, BASE_BODY, DOF, QPOS, ACTUATOR, FINGER_ACTUATOR, USERDATA, ROW_SIZE };

enum {  /* one arm's part of userdata */
  MODE, DELTA, FINGER = DELTA + 6, GOAL_POSITION, GOAL_ROTATION = GOAL_POSITION + 3,
  POSTURE = GOAL_ROTATION + 9, BLOCK_SIZE = POSTURE + JOINTS
};
enum { OFF, HOLD_GOAL, NEW_DELTA };  /* userdata is zeroed by mj_resetData: OFF is the state after it */

typedef mjtNum num;

static void cross(num out[3], const num a[3], const num b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static num norm(const num v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static void limit(num v[3], num largest) {
  num length = norm(v);
  if (length > largest)
    for (int i = 0; i < 3; i++) v[i] *= largest / length;
}

static void multiply(num out[9], const num a[9], const num b[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

static void turn(num out[3], const num rotation[9], const num v[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] + rotation[3 * i + 2] * v[2];
}

/* Rodrigues: the matrix of a rotation vector. */
static void rotation_exp(num out[9], const num v[3]) {
  num angle = norm(v), small = angle < 1e-9;
  num s = small ? 1 : sin(angle) / angle, c = small ? 0.5 : (1 - cos(angle)) / (angle * angle);
  num skew[9] = {0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0}, square[9];
  multiply(square, skew, skew);
  for (int i = 0; i < 9; i++) out[i] = s * skew[i] + c * square[i] + (i % 4 == 0);
}

/* The rotation vector that turns `from` into `to`. */
static void rotation_error(num out[3], const num to[9], const num from[9]) {
  num transposed[9], r[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) transposed[3 * i + j] = from[3 * j + i];
  multiply(r, to, transposed);
  out[0] = 0.5 * (r[7] - r[5]);
  out[1] = 0.5 * (r[2] - r[6]);
  out[2] = 0.5 * (r[3] - r[1]);
  num sine = norm(out), cosine = 0.5 * (r[0] + r[4] + r[8] - 1);
  num scale = sine < 1e-9 ? 1 : atan2(sine, cosine) / sine;
  for (int i = 0; i < 3; i++) out[i] *= scale;
}

/* Lower Cholesky factor of a symmetric matrix, with the reciprocals of its diagonal in the diagonal's place: a division
 * takes as long as a dozen products. `n` is a constant at every call, so that the loops unroll. */
static inline __attribute__((always_inline)) void cholesky(int n, num *l, const num *a) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      num sum = a[i * n + j];
      for (int k = 0; k < j; k++) sum -= l[i * n + k] * l[j * n + k];
      l[i * n + j] = i == j ? 1 / sqrt(sum > 1e-12 ? sum : 1e-12) : sum * l[j * n + j];
    }
}

/* x := L^-1 x */
static inline __attribute__((always_inline)) void forward(int n, num *x, const num *l) {
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < i; k++) x[i] -= l[i * n + k] * x[k];
    x[i] *= l[i * n + i];
  }
}

/* x := L^-T x */
static inline __attribute__((always_inline)) void backward(int n, num *x, const num *l) {
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++) x[i] -= l[k * n + i] * x[k];
    x[i] *= l[i * n + i];
  }
}

/* A new command: the goal is the measured pose moved by `delta`, given along the base frame's axes. */
static void set_goal(num *block, const num base[9], const num origin[3], const num position[3],
                     const num rotation[9]) {
  num shift[3], axis[3], spin[9];
  turn(shift, base, block + DELTA);
  turn(axis, base, block + DELTA + 3);
  rotation_exp(spin, axis);
  for (int i = 0; i < 3; i++) block[GOAL_POSITION + i] = position[i] + shift[i];
  multiply(block + GOAL_ROTATION, spin, rotation);
  /* The elbow stays over the line from base to tool: left behind, it would tie the arm up at its sides. */
  num way[3];
  for (int i = 0; i < 3; i++) way[i] = block[GOAL_POSITION + i] - origin[i];
  block[POSTURE] = atan2(base[1] * way[0] + base[4] * way[1] + base[7] * way[2],
                         base[0] * way[0] + base[3] * way[1] + base[6] * way[2]);
  block[MODE] = HOLD_GOAL;
}

/* Rotation first, then translation: the last pivots of A are then the mobility that is left for translation with the
 * orientation kept, which is what vanishes when an arm is stretched. */
static void tool_jacobian(num J[6][JOINTS], const num *cdof, const num *center_of_mass, const num *tool) {
  num lever[3], arc[3];
  for (int i = 0; i < 3; i++) lever[i] = tool[i] - center_of_mass[i];
  for (int k = 0; k < JOINTS; k++) {
    const num *motion = cdof + 6 * k;
    cross(arc, motion, lever);
    for (int i = 0; i < 3; i++) {
      J[i][k] = motion[i];
      J[3 + i][k] = motion[3 + i] + arc[i];
    }
  }
}

/* From the packed rows of a chain: row k holds k + 1 numbers. */
static void mass_matrix(num M[JOINTS][JOINTS], const num *packed, const int *row_starts) {
  for (int i = 0; i < JOINTS; i++)
    for (int j = 0; j <= i; j++) M[i][j] = M[j][i] = packed[row_starts[i] + j];
}

/* A = J M^-1 J' = W W' with the rows of W = (L^-1 J')', where M = L L'. */
static void task_mobility(num A[6][6], num J[6][JOINTS], num M[JOINTS][JOINTS]) {
  num L[JOINTS][JOINTS], W[6][JOINTS];
  cholesky(JOINTS, L[0], M[0]);
  for (int i = 0; i < 6; i++) {
    for (int k = 0; k < JOINTS; k++) W[i][k] = J[i][k];
    forward(JOINTS, W[i], L[0]);
    for (int j = 0; j <= i; j++) {
      num sum = 0;
      for (int k = 0; k < JOINTS; k++) sum += W[i][k] * W[j][k];
      A[i][j] = A[j][i] = sum;
    }
  }
}

/* Cholesky factor of A + D. D is 0 in the work space and grows to the regular mobilities where a direction is lost. */
static void factor_damped(num C[6][6], num A[6][6], const num *config) {
  num regular[6], lost = 0;
  cholesky(6, C[0], A[0]);
  for (int i = 0; i < 6; i++) {
    regular[i] = config[i < 3 ? REGULAR_MOBILITY_ORIENTATION : REGULAR_MOBILITY_POSITION];
    num share = 1 - 1 / (C[i][i] * C[i][i] * regular[i]);
    if (share > lost) lost = share;
  }
  if (lost == 0) return;
  for (int i = 0; i < 6; i++) A[i][i] += lost * lost * regular[i];
  cholesky(6, C[0], A[0]);
}

static void pose_error(num error[6], const num *block, const num *position, const num *rotation, const num *config) {
  rotation_error(error, block + GOAL_ROTATION, rotation);
  for (int i = 0; i < 3; i++) error[3 + i] = block[GOAL_POSITION + i] - position[i];
  limit(error, config[MAX_ORIENTATION_ERROR]);
  limit(error + 3, config[MAX_POSITION_ERROR]);
}

static void control_arm(const mjModel *m, mjData *d, const num *config, const num *row) {
  num *block = d->userdata + (int)row[USERDATA];
  if (block[MODE] == OFF) return;
  const int dof = (int)row[DOF], base = (int)row[BASE_BODY], actuator = (int)row[ACTUATOR];
  const num *position = d->site_xpos + 3 * (int)row[SITE], *rotation = d->site_xmat + 9 * (int)row[SITE];
  const num *qpos = d->qpos + (int)row[QPOS], *qvel = d->qvel + dof;
  if (block[MODE] == NEW_DELTA) set_goal(block, d->xmat + 9 * base, d->xpos + 3 * base, position, rotation);

  num J[6][JOINTS], M[JOINTS][JOINTS], A[6][6], C[6][6], F[6], a0[JOINTS];
  tool_jacobian(J, d->cdof + 6 * dof, d->subtree_com + 3 * m->body_rootid[base], position);
  mass_matrix(M, d->M, m->M_rowadr + dof);
  task_mobility(A, J, M);
  factor_damped(C, A, config);

  /* Task acceleration, less what the pull towards the posture would do to the tool, then to forces. */
  const num kp_posture = config[KP_POSTURE], kd_posture = 2 * sqrt(kp_posture);
  for (int k = 0; k < JOINTS; k++) a0[k] = kp_posture * (block[POSTURE + k] - qpos[k]) - kd_posture * qvel[k];
  pose_error(F, block, position, rotation, config);
  for (int i = 0; i < 6; i++) {
    const num kp = config[i < 3 ? KP_ORIENTATION : KP_POSITION], kd = 2 * sqrt(kp);
    F[i] *= kp;
    for (int k = 0; k < JOINTS; k++) F[i] -= J[i][k] * (kd * qvel[k] + a0[k]);
  }
  forward(6, F, C[0]);
  backward(6, F, C[0]);

  for (int k = 0; k < JOINTS; k++) {
    num torque = d->qfrc_bias[dof + k] - d->qfrc_passive[dof + k];
    for (int i = 0; i < 6; i++) torque += J[i][k] * F[i];
    for (int n = 0; n < JOINTS; n++) torque += M[k][n] * a0[n];
    const num *range = m->actuator_ctrlrange + 2 * (actuator + k);
    d->ctrl[actuator + k] = torque < range[0] ? range[0] : torque > range[1] ? range[1] : torque;
  }
  for (int finger = 0; finger < 2; finger++) d->ctrl[(int)row[FINGER_ACTUATOR] + finger] = block[FINGER];
}

void mart_osc_control(const mjModel *m, mjData *d) {
  if (!m->nnumeric || m->numeric_size[0] < HEADER_SIZE) return;
  const num *config = m->numeric_data + m->numeric_adr[0];
  if (config[MAGIC_NUMBER] != MAGIC) return;
  for (int arm = 0; arm < (int)config[ARMS]; arm++)
    control_arm(m, d, config, config + HEADER_SIZE + arm * ROW_SIZE);
}

/* The MuJoCo that this file was compiled against; struct offsets change between versions. */
int mart_osc_mujoco_version(void) { return mjVERSION_HEADER; }
