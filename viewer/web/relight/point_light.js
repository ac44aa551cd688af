// SPDX-License-Identifier: BSD-3-Clause
// Parallel light from any direction, as shares of the directions that a model knows; the rules of
// fields/light_triangulation.h.
import { sphericalHull } from './spherical_hull.js';
import { angleBetween, cross, dot, vectorAt } from './vectors.js';

const kSame = 1e-4; // radians: of closer directions the first counts
const kMostHull = 5000; // directions; of more, the nearest alone gives light
const kWideGap = 3; // times the usual triangle: no light was taken there
const kLeastGap = Math.PI / 6; // radians; smaller triangles are no gaps
const kMostGap = 89.9 * Math.PI / 180; // larger ones do not surround a direction
const kSameAngle = 1e-9; // radians

/**
 * Between three directions that surround it, light has barycentric shares of them (of the plane
 * through their tips), which are continuous and never negative. Beyond the directions (a dome lights
 * from above alone) it is moved to the rim.
 */
export class PointLight {
  /** `directions`: x, y, z each, unit. */
  constructor(directions) {
    this.sites = distinct(directions);
    this.points = this.sites.map(({ point }) => point);
    const hull = this.points.length > kMostHull ? [] : sphericalHull(this.points);
    const caps = hull.map((corners) => capOf(this.points, corners));
    const proper = caps.filter((cap) => cap < kMostGap).sort((a, b) => a - b);
    const usual = proper[proper.length >> 1];
    const widest = Math.min(Math.max(kWideGap * usual, kLeastGap), kMostGap);
    this.triangles = hull.filter((_, i) => caps[i] <= widest);
    this.rim = this.makeRim(hull);
    const lengths = this.triangles.length > 0 ? caps.filter((cap) => cap <= widest)
      : this.rim.map(([a, b]) => angleBetween(this.points[a], this.points[b]));
    // From a direction, in radians, as far as light reaches outside the triangles.
    this.reach = lengths.length === 0 ? Math.PI / 2
      : lengths.sort((a, b) => a - b)[lengths.length >> 1];
  }

  // Where triangles end. Points of one great circle have none: what joins them is all there is.
  makeRim(hull) {
    if (this.points.length === 2) return [[0, 1]];
    const edges = this.triangles.length > 0 ? rimOf(this.triangles)
      : hull.flatMap(([a, b, c]) => [[a, b], [b, c], [c, a]]);
    const lengthOf = ([a, b]) => angleBetween(this.points[a], this.points[b]);
    return edges.sort((a, b) => lengthOf(a) - lengthOf(b)); // of equals the shorter counts
  }

  /** [{index, share}] of directions; shares are positive and sum to 1. */
  sharesOf(direction) {
    const found = this.insideTriangle(direction) ?? this.onRim(direction);
    return found.filter(([, share]) => share > 0)
      .map(([site, share]) => ({ index: this.sites[site].index, share }));
  }

  /** Whether surroundings in `direction`, `angle` from the nearest one, are told by these. */
  reaches(direction, angle) {
    const surrounded = this.triangles.length > 0 && this.rim.length === 0;
    return surrounded || angle <= this.reach || this.insideTriangle(direction) !== null;
  }

  insideTriangle(direction) {
    let best = null, most = -1e-9;
    for (const corners of this.triangles) {
      const [a, b, c] = corners.map((i) => this.points[i]);
      const volumes = [dot(direction, cross(b, c)), dot(direction, cross(c, a)),
                       dot(direction, cross(a, b))];
      const sum = volumes[0] + volumes[1] + volumes[2];
      const least = Math.min(...volumes) / sum;
      if (!(sum > 0 && least > most)) continue;
      most = least;
      best = corners.map((corner, k) => [corner, Math.max(0, volumes[k]) / sum]);
    }
    return best;
  }

  onRim(direction) {
    let best = [[this.nearest(direction), 1]], nearest = Infinity;
    for (const [from, to] of this.rim) {
      const share = shareAlong(this.points[from], this.points[to], direction);
      const point = [0, 1, 2].map((i) =>
        (1 - share) * this.points[from][i] + share * this.points[to][i]);
      const angle = angleBetween(point, direction); // scale does not matter
      if (!(angle < nearest - kSameAngle)) continue;
      nearest = angle;
      best = [[from, 1 - share], [to, share]];
    }
    return best;
  }

  nearest(direction) {
    let best = 0;
    this.points.forEach((point, i) => {
      if (dot(point, direction) > dot(this.points[best], direction)) best = i;
    });
    return best;
  }
}

function distinct(directions) {
  const sites = [], cells = new Map();
  const cellOf = (x) => Math.round(x / (4 * kSame));
  for (let i = 0; i < directions.length / 3; ++i) {
    const point = vectorAt(directions, i);
    const [x, y, z] = point.map(cellOf);
    let site = null;
    for (let n = 0; n < 27 && site === null; ++n) {
      const key = [x + n % 3 - 1, y + Math.floor(n / 3) % 3 - 1, z + Math.floor(n / 9) - 1].join();
      site = cells.get(key)?.find((other) => angleBetween(other.point, point) < kSame) ?? null;
    }
    if (site !== null) continue;
    site = { point, index: i };
    sites.push(site);
    const key = [x, y, z].join();
    cells.set(key, [...cells.get(key) ?? [], site]);
  }
  return sites;
}

// The angle between a triangle's corners and the middle of the circle through them.
function capOf(points, corners) {
  const [a, b, c] = corners.map((i) => points[i]);
  const normal = cross([b[0] - a[0], b[1] - a[1], b[2] - a[2]],
                       [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
  return Math.atan2(Math.hypot(...cross(normal, a)), dot(normal, a));
}

// Edges that one triangle alone has.
function rimOf(triangles) {
  const edges = new Map();
  for (const [a, b, c] of triangles) {
    for (const edge of [[a, b], [b, c], [c, a]]) {
      if (!edges.delete([edge[1], edge[0]].join())) edges.set(edge.join(), edge);
    }
  }
  return [...edges.values()];
}

// Where on the chord from a to b the arc is nearest to `direction`, 0 to 1.
function shareAlong(a, b, direction) {
  const normal = cross(a, b);
  const square = dot(normal, normal);
  if (square < 1e-12) return dot(a, direction) >= dot(b, direction) ? 0 : 1; // opposite ends
  const height = dot(direction, normal) / square;
  const foot = direction.map((value, i) => value - height * normal[i]); // in the plane of a, b
  const fromA = dot(cross(a, foot), normal), toB = dot(cross(foot, b), normal);
  if (fromA <= 0 && toB <= 0) return dot(a, direction) >= dot(b, direction) ? 0 : 1;
  if (fromA <= 0) return 0;
  if (toB <= 0) return 1;
  return fromA / (fromA + toB);
}
