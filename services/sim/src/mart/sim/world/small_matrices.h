/* Vectors of three numbers and small matrices, row by row, for osc.c. */
#ifndef MART_SMALL_MATRICES_H
#define MART_SMALL_MATRICES_H

#include <math.h>
#include <mujoco/mjtype.h>

typedef mjtNum num;

/* The sizes of loops are arguments, and constants at every call, so that the loops unroll. */
#define INLINE static inline __attribute__((always_inline))

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
 * takes as long as a dozen products. The first n of each `width` columns are used. */
INLINE void cholesky(int n, int width, num *l, const num *a) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      num sum = a[i * width + j];
      for (int k = 0; k < j; k++) sum -= l[i * width + k] * l[j * width + k];
      l[i * width + j] = i == j ? 1 / sqrt(sum > 1e-12 ? sum : 1e-12) : sum * l[j * width + j];
    }
}

/* x := L^-1 x */
INLINE void forward(int n, int width, num *x, const num *l) {
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < i; k++) x[i] -= l[i * width + k] * x[k];
    x[i] *= l[i * width + i];
  }
}

/* x := L^-T x */
INLINE void backward(int n, int width, num *x, const num *l) {
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++) x[i] -= l[k * width + i] * x[k];
    x[i] *= l[i * width + i];
  }
}

/* Jacobi's eigenvalues of a symmetric matrix, which ends up diagonal, and its eigenvectors, the columns of V. */
static void eigen(num B[6][6], num V[6][6]) {
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) V[i][j] = i == j;
  for (int sweep = 0; sweep < 12; sweep++) {
    num apart = 0, together = 0;
    for (int i = 0; i < 6; i++) {
      together += B[i][i] * B[i][i];
      for (int j = 0; j < i; j++) apart += B[i][j] * B[i][j];
    }
    if (apart <= 1e-24 * together) return;
    for (int p = 0; p < 5; p++)
      for (int q = p + 1; q < 6; q++) {
        if (B[p][q] == 0) continue;
        num theta = (B[q][q] - B[p][p]) / (2 * B[p][q]);
        num t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 6; k++) {
          num one = B[k][p], other = B[k][q];
          B[k][p] = c * one - s * other;
          B[k][q] = s * one + c * other;
        }
        for (int k = 0; k < 6; k++) {
          num one = B[p][k], other = B[q][k];
          B[p][k] = c * one - s * other;
          B[q][k] = s * one + c * other;
          one = V[k][p], other = V[k][q];
          V[k][p] = c * one - s * other;
          V[k][q] = s * one + c * other;
        }
      }
  }
}

#endif
