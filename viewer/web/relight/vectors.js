// SPDX-License-Identifier: BSD-3-Clause
// Vectors of three numbers.

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];
export const normalize = (a) => scale(a, 1 / Math.hypot(...a));
/** Of unit vectors, in radians; accurate near 0 and pi. */
export const angleBetween = (a, b) => Math.atan2(Math.hypot(...cross(a, b)), dot(a, b));
/** Direction number `i` of x, y, z each. */
export const vectorAt = (values, i) => [values[3 * i], values[3 * i + 1], values[3 * i + 2]];
