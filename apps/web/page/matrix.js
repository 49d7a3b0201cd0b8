// SPDX-License-Identifier: BSD-3-Clause
// Points and 4 x 4 matrices, column-major, in double, of the page's headset view. Each function writes into its first
// argument, so that a frame makes no objects. A similarity is a rotation, one scale, and a place.
/** @typedef {Float64Array | Float32Array | number[]} Numbers */

export const matrix = () => new Float64Array(16);
export const point = () => new Float64Array(3);

/** Also of a matrix: its place. */
export const ORIGIN = point();

/** RAS to WebXR's axes: right stays right, anterior goes to -z (ahead), superior to +y (up). Its determinant is 1: left
 * stays left. */
export const XR_FROM_RAS = Float64Array.of(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);

/** a b; neither is `out`. @param {Float64Array} out @param {Numbers} a @param {Numbers} b */
export function times(out, a, b) {
  for (let c = 0; c < 16; c += 4) for (let r = 0; r < 4; r++) out[c + r] = a[r] * b[c] + a[4 + r] * b[c + 1] + a[8 + r] * b[c + 2] + a[12 + r] * b[c + 3];
  return out;
}

/** A place (w is 1) or a direction (0) through a matrix; `out` may be p. @param {Float64Array} out @param {Numbers} m @param {Numbers} p @param {number} [w] */
export function apply(out, m, p, w = 1) {
  const x = p[0], y = p[1], z = p[2];
  for (let r = 0; r < 3; r++) out[r] = m[r] * x + m[4 + r] * y + m[8 + r] * z + w * m[12 + r];
  return out;
}

/** The inverse of a similarity. @param {Float64Array} out @param {Numbers} m */
export function invert(out, m) {
  const square = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
  for (let c = 0; c < 3; c++) {
    for (let r = 0; r < 3; r++) out[4 * c + r] = m[4 * r + c] / square;
    out[4 * c + 3] = 0;
  }
  for (let r = 0; r < 3; r++) out[12 + r] = -(out[r] * m[12] + out[4 + r] * m[13] + out[8 + r] * m[14]);
  out[15] = 1;
  return out;
}

/** Three columns and a place. @param {Float64Array} out @param {Numbers} x @param {Numbers} y @param {Numbers} z @param {Numbers} at */
export function columns(out, x, y, z, at) {
  for (let r = 0; r < 3; r++) {
    out[r] = x[r];
    out[4 + r] = y[r];
    out[8 + r] = z[r];
    out[12 + r] = at[r];
  }
  out[3] = out[7] = out[11] = 0;
  out[15] = 1;
  return out;
}

/** A turn by a quaternion of any length, and a scale, that bring one place to another. @param {Float64Array} out @param {number} x
 * @param {number} y @param {number} z @param {number} w @param {number} scale @param {Numbers} to @param {Numbers} [from] */
export function similarity(out, x, y, z, w, scale, to, from = ORIGIN) {
  const s = 2 / (x * x + y * y + z * z + w * w);
  out[0] = scale * (1 - s * (y * y + z * z));
  out[1] = scale * s * (x * y + w * z);
  out[2] = scale * s * (x * z - w * y);
  out[4] = scale * s * (x * y - w * z);
  out[5] = scale * (1 - s * (x * x + z * z));
  out[6] = scale * s * (y * z + w * x);
  out[8] = scale * s * (x * z + w * y);
  out[9] = scale * s * (y * z - w * x);
  out[10] = scale * (1 - s * (x * x + y * y));
  for (let r = 0; r < 3; r++) out[12 + r] = to[r] - out[r] * from[0] - out[4 + r] * from[1] - out[8 + r] * from[2];
  out[3] = out[7] = out[11] = 0;
  out[15] = 1;
  return out;
}

export const dot = (/** @type {Numbers} */ p, /** @type {Numbers} */ q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
export const length = (/** @type {Numbers} */ p) => Math.hypot(p[0], p[1], p[2]);

/** p + t q; `out` may be either. @param {Float64Array} out @param {Numbers} p @param {Numbers} q @param {number} t */
export function plus(out, p, q, t) {
  for (let a = 0; a < 3; a++) out[a] = p[a] + t * q[a];
  return out;
}

/** Neither is `out`. @param {Float64Array} out @param {Numbers} p @param {Numbers} q */
export function cross(out, p, q) {
  out[0] = p[1] * q[2] - p[2] * q[1];
  out[1] = p[2] * q[0] - p[0] * q[2];
  out[2] = p[0] * q[1] - p[1] * q[0];
  return out;
}

/** @param {Float64Array} p @param {number} by */
export function scale(p, by) {
  for (let a = 0; a < 3; a++) p[a] *= by;
  return p;
}

/** Makes p 1 long. @param {Float64Array} p */
export const unit = (p) => scale(p, 1 / (length(p) || 1));

const u = point(), v = point(), axis = point(), from = point(), to = point();

/** The similarity that brings two places, a and b, to c and d by the least turn. @param {Float64Array} out @param {Numbers} a @param {Numbers} b
 * @param {Numbers} c @param {Numbers} d */
export function between(out, a, b, c, d) {
  plus(u, b, a, -1);
  plus(v, d, c, -1);
  plus(from, a, u, 0.5);
  plus(to, c, v, 0.5);
  const scale = length(v) / Math.max(length(u), 1e-3);
  const cosine = dot(unit(u), unit(v));
  cross(axis, u, v); // of the quaternion of twice the half angle: (axis, 1 + cosine)
  if (cosine < -0.999999) axis[0] = 1;
  return similarity(out, axis[0], axis[1], axis[2], 1 + cosine, scale, to, from);
}
