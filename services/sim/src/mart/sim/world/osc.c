/* Operational-space control of arms of five to seven joints, run by MuJoCo inside every substep (`mjcb_control`).
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
 * with a magic number. That numeric holds gains and indices; the arms' commands are in mjData.userdata, which is part
 * of the saved state. osc.py writes both and mirrors the layouts below. There are two: PANDAS_MAGIC is that of models
 * whose arms are all Pandas, with one set of gains; ARMS_MAGIC says of each arm what it is. Where a direction is nearly
 * lost, the first adds D to all six, as every version has, so that what was recorded comes out to the same bits; the
 * second finds the lost directions and damps those alone (decision 0072).
 */
#include <mujoco/mjdata.h>
#include <mujoco/mjmodel.h>
#include <mujoco/mujoco.h>

#include "small_matrices.h"

#define PANDAS_MAGIC 1296126548.0 /* "MART" in ASCII */
#define ARMS_MAGIC 1296126514.0   /* "MAR2" */
#define MAX_JOINTS 7

/* The numeric: magic number and number of arms; of Pandas the gains; then one row for each arm. */
enum { MAGIC_NUMBER, ARMS, HEADER_SIZE };
enum {  /* the gains */
  KP_POSITION, KP_ORIENTATION, KP_POSTURE, MAX_POSITION_ERROR, MAX_ORIENTATION_ERROR, REGULAR_MOBILITY_POSITION,
  REGULAR_MOBILITY_ORIENTATION, GAINS_SIZE
};
enum {  /* a row: a Panda's is the beginning of another arm's */
  SITE, BASE_BODY, DOF, QPOS, ACTUATOR, FINGER_ACTUATOR, USERDATA, PANDA_ROW_SIZE,
  JOINTS = PANDA_ROW_SIZE, FINGERS, SECOND_FINGER_ACTUATOR, FINGER_SCALE, FINGER_OFFSET, JOINT1_SIGN, JOINT1_OFFSET,
  GAINS, ARM_ROW_SIZE = GAINS + GAINS_SIZE
};

enum {  /* one arm's part of userdata */
  MODE, DELTA, FINGER = DELTA + 6, GOAL_POSITION, GOAL_ROTATION = GOAL_POSITION + 3,
  POSTURE = GOAL_ROTATION + 9, BLOCK_SIZE = POSTURE + MAX_JOINTS
};
enum { OFF, HOLD_GOAL, NEW_DELTA };  /* userdata is zeroed by mj_resetData: OFF is the state after it */

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
INLINE void tool_jacobian(int joints, num J[6][MAX_JOINTS], const num *cdof, const num *center_of_mass,
                          const num *tool) {
  num lever[3], arc[3];
  for (int i = 0; i < 3; i++) lever[i] = tool[i] - center_of_mass[i];
  for (int k = 0; k < joints; k++) {
    const num *motion = cdof + 6 * k;
    cross(arc, motion, lever);
    for (int i = 0; i < 3; i++) {
      J[i][k] = motion[i];
      J[3 + i][k] = motion[3 + i] + arc[i];
    }
  }
}

/* From the packed rows of a chain: row k holds k + 1 numbers. */
INLINE void mass_matrix(int joints, num M[MAX_JOINTS][MAX_JOINTS], const num *packed, const int *row_starts) {
  for (int i = 0; i < joints; i++)
    for (int j = 0; j <= i; j++) M[i][j] = M[j][i] = packed[row_starts[i] + j];
}

/* A = J M^-1 J' = W W' with the rows of W = (L^-1 J')', where M = L L'. */
INLINE void task_mobility(int joints, num A[6][6], num J[6][MAX_JOINTS], num M[MAX_JOINTS][MAX_JOINTS]) {
  num L[MAX_JOINTS][MAX_JOINTS], W[6][MAX_JOINTS];
  cholesky(joints, MAX_JOINTS, L[0], M[0]);
  for (int i = 0; i < 6; i++) {
    for (int k = 0; k < joints; k++) W[i][k] = J[i][k];
    forward(joints, MAX_JOINTS, W[i], L[0]);
    for (int j = 0; j <= i; j++) {
      num sum = 0;
      for (int k = 0; k < joints; k++) sum += W[i][k] * W[j][k];
      A[i][j] = A[j][i] = sum;
    }
  }
}

/* Cholesky factor of A + D. D is 0 in the work space and grows to the regular mobilities where a direction is lost. */
static void factor_damped(num C[6][6], num A[6][6], const num *gains) {
  num regular[6], lost = 0;
  cholesky(6, 6, C[0], A[0]);
  for (int i = 0; i < 6; i++) {
    regular[i] = gains[i < 3 ? REGULAR_MOBILITY_ORIENTATION : REGULAR_MOBILITY_POSITION];
    num share = 1 - 1 / (C[i][i] * C[i][i] * regular[i]);
    if (share > lost) lost = share;
  }
  if (lost == 0) return;
  for (int i = 0; i < 6; i++) A[i][i] += lost * lost * regular[i];
  cholesky(6, 6, C[0], A[0]);
}

/* Whether no eigenvalue of A, scaled by the regular mobilities, may be below 1: the Frobenius norm of its inverse
 * bounds the largest one of the inverse. C is the Cholesky factor of A. */
static int is_regular(num C[6][6], const num *scale) {
  num inverse[6][6] = {{0}}, total = 0;  /* of the factor, each row an equation */
  for (int j = 0; j < 6; j++) {
    inverse[j][j] = C[j][j] * scale[j];
    for (int i = j + 1; i < 6; i++) {
      num sum = 0;
      for (int k = j; k < i; k++) sum -= C[i][k] * inverse[k][j];
      inverse[i][j] = sum * C[i][i];
    }
  }
  for (int i = 0; i < 6; i++)
    for (int j = 0; j <= i; j++) {
      num sum = 0;
      for (int k = i; k < 6; k++) sum += inverse[k][i] * inverse[k][j];
      total += (i == j ? 1 : 2) * sum * sum;
    }
  return total <= 1;
}

/* Cholesky factor of A + D, D of the lost directions alone: of A scaled by the regular mobilities, every eigenvalue l
 * below 1 becomes l + (1 - l)^2. */
static void factor_damped_where_lost(num C[6][6], num A[6][6], const num *gains) {
  num scale[6], B[6][6], V[6][6];
  for (int i = 0; i < 6; i++)
    scale[i] = sqrt(gains[i < 3 ? REGULAR_MOBILITY_ORIENTATION : REGULAR_MOBILITY_POSITION]);
  cholesky(6, 6, C[0], A[0]);
  if (is_regular(C, scale)) return;
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) B[i][j] = A[i][j] / (scale[i] * scale[j]);
  eigen(B, V);
  for (int k = 0; k < 6; k++) {
    num lost = 1 - B[k][k];
    if (lost <= 0) continue;
    for (int i = 0; i < 6; i++)
      for (int j = 0; j < 6; j++) A[i][j] += lost * lost * scale[i] * V[i][k] * V[j][k] * scale[j];
  }
  cholesky(6, 6, C[0], A[0]);
}

static void pose_error(num error[6], const num *block, const num *position, const num *rotation, const num *gains) {
  rotation_error(error, block + GOAL_ROTATION, rotation);
  for (int i = 0; i < 3; i++) error[3 + i] = block[GOAL_POSITION + i] - position[i];
  limit(error, gains[MAX_ORIENTATION_ERROR]);
  limit(error + 3, gains[MAX_POSITION_ERROR]);
}

INLINE void control_joints(int joints, const mjModel *m, mjData *d, const num *row, const num *gains, int pandas) {
  num *block = d->userdata + (int)row[USERDATA];
  const int dof = (int)row[DOF], base = (int)row[BASE_BODY], actuator = (int)row[ACTUATOR];
  const num *position = d->site_xpos + 3 * (int)row[SITE], *rotation = d->site_xmat + 9 * (int)row[SITE];
  const num *qpos = d->qpos + (int)row[QPOS], *qvel = d->qvel + dof;
  if (block[MODE] == NEW_DELTA) {
    set_goal(block, d->xmat + 9 * base, d->xpos + 3 * base, position, rotation);
    if (!pandas) block[POSTURE] = row[JOINT1_SIGN] * block[POSTURE] + row[JOINT1_OFFSET];
  }

  num J[6][MAX_JOINTS], M[MAX_JOINTS][MAX_JOINTS], A[6][6], C[6][6], F[6], a0[MAX_JOINTS];
  tool_jacobian(joints, J, d->cdof + 6 * dof, d->subtree_com + 3 * m->body_rootid[base], position);
  mass_matrix(joints, M, d->M, m->M_rowadr + dof);
  task_mobility(joints, A, J, M);
  if (pandas)
    factor_damped(C, A, gains);
  else
    factor_damped_where_lost(C, A, gains);

  /* Task acceleration, less what the pull towards the posture would do to the tool, then to forces. */
  const num kp_posture = gains[KP_POSTURE], kd_posture = 2 * sqrt(kp_posture);
  for (int k = 0; k < joints; k++) a0[k] = kp_posture * (block[POSTURE + k] - qpos[k]) - kd_posture * qvel[k];
  pose_error(F, block, position, rotation, gains);
  for (int i = 0; i < 6; i++) {
    const num kp = gains[i < 3 ? KP_ORIENTATION : KP_POSITION], kd = 2 * sqrt(kp);
    F[i] *= kp;
    for (int k = 0; k < joints; k++) F[i] -= J[i][k] * (kd * qvel[k] + a0[k]);
  }
  forward(6, 6, F, C[0]);
  backward(6, 6, F, C[0]);

  for (int k = 0; k < joints; k++) {
    num torque = d->qfrc_bias[dof + k] - d->qfrc_passive[dof + k];
    for (int i = 0; i < 6; i++) torque += J[i][k] * F[i];
    for (int n = 0; n < joints; n++) torque += M[k][n] * a0[n];
    const num *range = m->actuator_ctrlrange + 2 * (actuator + k);
    d->ctrl[actuator + k] = torque < range[0] ? range[0] : torque > range[1] ? range[1] : torque;
  }
}

/* A Panda has two fingers, whose servos follow one another. */
static void control_fingers(mjData *d, const num *row, int pandas) {
  const num target = d->userdata[(int)row[USERDATA] + FINGER];
  const int first = (int)row[FINGER_ACTUATOR];
  if (pandas) {
    d->ctrl[first] = d->ctrl[first + 1] = target;
    return;
  }
  const int fingers = (int)row[FINGERS];
  const num scaled = row[FINGER_OFFSET] + row[FINGER_SCALE] * target;
  if (fingers > 0) d->ctrl[first] = scaled;
  if (fingers > 1) d->ctrl[(int)row[SECOND_FINGER_ACTUATOR]] = scaled;
}

static void control_pandas(const mjModel *m, mjData *d, const num *config) {
  const num *gains = config + HEADER_SIZE, *row = gains + GAINS_SIZE;
  for (int arm = 0; arm < (int)config[ARMS]; arm++, row += PANDA_ROW_SIZE) {
    if (d->userdata[(int)row[USERDATA] + MODE] == OFF) continue;
    control_joints(7, m, d, row, gains, 1);
    control_fingers(d, row, 1);
  }
}

static void control_arms(const mjModel *m, mjData *d, const num *config) {
  const num *row = config + HEADER_SIZE;
  for (int arm = 0; arm < (int)config[ARMS]; arm++, row += ARM_ROW_SIZE) {
    if (d->userdata[(int)row[USERDATA] + MODE] == OFF) continue;
    switch ((int)row[JOINTS]) {
      case 5: control_joints(5, m, d, row, row + GAINS, 0); break;
      case 6: control_joints(6, m, d, row, row + GAINS, 0); break;
      case 7: control_joints(7, m, d, row, row + GAINS, 0); break;
    }
    control_fingers(d, row, 0);
  }
}

void mart_osc_control(const mjModel *m, mjData *d) {
  if (!m->nnumeric || m->numeric_size[0] < HEADER_SIZE + GAINS_SIZE) return;
  const num *config = m->numeric_data + m->numeric_adr[0];
  if (config[MAGIC_NUMBER] == PANDAS_MAGIC) control_pandas(m, d, config);
  if (config[MAGIC_NUMBER] == ARMS_MAGIC) control_arms(m, d, config);
}

/* The MuJoCo that this file was compiled against; struct offsets change between versions. */
int mart_osc_mujoco_version(void) { return mjVERSION_HEADER; }
