// SPDX-License-Identifier: BSD-3-Clause
// How far what is shown reaches, in mm, world frame.
import { kWhereItIs, worldFromModel } from './placement.js';

/**
 * {low, high, center, radius} of positions x, y, z, x, ... that stand at `place` (placement.js):
 * their box, its centre, and how far from it they reach.
 */
export function boundsOf(positions, place = kWhereItIs) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  forEachPoint(positions, place, (point) => {
    for (let i = 0; i < 3; ++i) {
      low[i] = Math.min(low[i], point[i]);
      high[i] = Math.max(high[i], point[i]);
    }
  });
  const center = low.map((value, i) => (value + high[i]) / 2);
  return { low, high, center, radius: orOne(reach(positions, place, center)) };
}

/** Something of a scene: its bounds, and `reach(from)`, how far from a point it lies at most. */
export function placedPart(positions, place) {
  return { bounds: boundsOf(positions, place), reach: (from) => reach(positions, place, from) };
}

/**
 * The bounds of all `parts` (one at least) together, as of one mesh; `closest`: the radius of the
 * smallest of them.
 */
export function boundsTogether(parts) {
  const ends = (key, end) => [0, 1, 2].map((i) => end(...parts.map(({ bounds }) => bounds[key][i])));
  const low = ends('low', Math.min), high = ends('high', Math.max);
  const center = low.map((value, i) => (value + high[i]) / 2);
  const most = ({ bounds }) => distance(bounds.center, center) + bounds.radius;
  let radius = 0;
  for (const part of [...parts].sort((a, b) => most(b) - most(a))) {
    if (most(part) <= radius) break; // nor do those after it reach further
    radius = Math.max(radius, part.reach(center));
  }
  const closest = Math.min(...parts.map(({ bounds }) => bounds.radius));
  return { low, high, center, radius: orOne(radius), closest };
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const orOne = (radius) => (radius > 0 ? radius : 1);

function forEachPoint(positions, place, visit) {
  const toWorld = worldFromModel(place), point = [0, 0, 0];
  for (let i = 0; i < positions.length; i += 3) {
    toWorld(positions[i], positions[i + 1], positions[i + 2], point);
    visit(point);
  }
}

function reach(positions, place, from) {
  let most = 0;
  forEachPoint(positions, place, (point) => {
    most = Math.max(most, distance(point, from));
  });
  return most;
}
