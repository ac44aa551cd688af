// SPDX-License-Identifier: BSD-3-Clause
// Which of many directions is nearest: cells of an angular Voronoi diagram (Masselus 2002).
import { vectorAt } from './vectors.js';

/**
 * A function of a unit direction: the index of the nearest of `directions` (x, y, z each), the first
 * of equal ones.
 */
export function nearestFinder(directions) {
  const count = directions.length / 3;
  const order = Uint32Array.from({ length: count }, (_, i) => i)
    .sort((a, b) => directions[3 * a + 2] - directions[3 * b + 2] || a - b);
  const sorted = Float64Array.from({ length: 3 * count }, (_, i) =>
    directions[3 * order[Math.floor(i / 3)] + i % 3]);
  return (direction) => {
    const [x, y, z] = direction;
    let square = Infinity, best = -1;
    // Up and down from z, until the height alone is too far away.
    const start = firstAbove(sorted, z);
    const look = (i) => {
      const [dx, dy, dz] = vectorAt(sorted, i);
      if ((dz - z) ** 2 > square) return false;
      const own = (dx - x) ** 2 + (dy - y) ** 2 + (dz - z) ** 2;
      if (own < square || (own === square && order[i] < best)) {
        square = own;
        best = order[i];
      }
      return true;
    };
    let below = start - 1, above = start;
    for (let more = true; more;) {
      more = false;
      if (above < count) more = look(above) ? (++above, true) : (above = count, false);
      if (below >= 0) more = (look(below) ? (--below, true) : (below = -1, false)) || more;
    }
    return best;
  };
}

function firstAbove(sorted, z) {
  let low = 0, high = sorted.length / 3;
  while (low < high) {
    const middle = low + high >> 1;
    if (sorted[3 * middle + 2] < z) low = middle + 1;
    else high = middle;
  }
  return low;
}
