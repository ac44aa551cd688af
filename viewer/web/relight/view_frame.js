// SPDX-License-Identifier: BSD-3-Clause
// Directions of the world as the picture shows them.
import { add, cross, dot, normalize, scale } from './vectors.js';

// Unless told otherwise a picture's frame is the world's: x right, y up, z towards the viewer.
const kPictureFrame = [1, 0, 0, 0, -1, 0, 0, 0, -1];

/**
 * {right, up, back}: the picture's axes in the world, `back` towards the viewer. `text`: the nine
 * numbers of the rotation camera_from_world, row by row (x right, y down, z forward); where it is
 * none, the frame above.
 */
export function viewFrameOf(text) {
  const numbers = (text ?? '').trim().split(/\s+/).map(Number);
  const m = isRotation(numbers) ? numbers : kPictureFrame;
  return { right: m.slice(0, 3), up: scale(m.slice(3, 6), -1), back: scale(m.slice(6, 9), -1) };
}

function isRotation(m) {
  if (m.length !== 9 || !m.every(Number.isFinite)) return false;
  const [x, y, z] = [m.slice(0, 3), m.slice(3, 6), m.slice(6, 9)];
  const errors = [dot(x, x) - 1, dot(y, y) - 1, dot(x, y), ...z.map((v, i) => v - cross(x, y)[i])];
  return errors.every((error) => Math.abs(error) < 1e-4);
}

/**
 * {right, up, front} of surroundings that stand upright: `up` is the axis of the world that points
 * upwards most in the picture, `front` points to the viewer's side.
 */
export function uprightFrameOf({ up, back }) {
  const k = [0, 1, 2].reduce((best, i) => (Math.abs(up[i]) > Math.abs(up[best]) ? i : best), 0);
  const axis = [0, 0, 0];
  axis[k] = Math.sign(up[k]);
  let front = add(back, scale(axis, -dot(back, axis)));
  if (Math.hypot(...front) < 1e-3) front = add(up, scale(axis, -dot(up, axis)));
  front = normalize(front);
  return { right: cross(axis, front), up: axis, front };
}

/**
 * The direction of light for a place in the picture, x to the right and y upwards, 1 at its nearer
 * edge: the middle lights from the viewer, the edge from the side, beyond it from behind.
 */
export function directionAt(frame, x, y) {
  const radius = Math.hypot(x, y);
  const angle = Math.min(radius, 2) * Math.PI / 2;
  const aside = radius === 0 ? 0 : Math.sin(angle) / radius;
  return inWorld(frame, [aside * x, aside * y, Math.cos(angle)]);
}

/** Of a direction in the picture's axes: right, up, towards the viewer. */
export const inWorld = ({ right, up, back }, [x, y, z]) =>
  normalize(add(add(scale(right, x), scale(up, y)), scale(back, z)));

export const inView = ({ right, up, back }, direction) =>
  [dot(right, direction), dot(up, direction), dot(back, direction)];

/** `direction` moved by angles over the ball that the viewer sees, to the right and upwards. */
export function turned(frame, direction, toRight, upwards) {
  const [x, y, z] = inView(frame, direction);
  const s = Math.sin(toRight), c = Math.cos(toRight);
  const x1 = c * x + s * z, z1 = c * z - s * x;
  const s2 = Math.sin(upwards), c2 = Math.cos(upwards);
  return inWorld(frame, [x1, c2 * y + s2 * z1, c2 * z1 - s2 * y]);
}

/** [degrees to the right, degrees up] of where light comes from, as seen from the picture's middle. */
export function anglesOf(frame, direction) {
  const [x, y, z] = inView(frame, direction);
  return [Math.atan2(x, z), Math.asin(Math.max(-1, Math.min(1, y)))]
    .map((angle) => angle * 180 / Math.PI);
}

/**
 * Degrees that the picture of surroundings of the user's own is turned by, before any other turn:
 * where +z is up its middle lies at +x of the world, as fields/light_probe.h has it; else behind the
 * object.
 */
export function turnOfWorld({ up, front }) {
  if (up[2] !== 1) return 0;
  return Math.atan2(front[1], -front[0]) * 180 / Math.PI;
}
