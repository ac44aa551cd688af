// SPDX-License-Identifier: BSD-3-Clause
// The convex hull of points on the unit sphere: their Delaunay triangulation.
import { cross, minus, normalize } from './vectors.js';

// Points of a common plane are told apart by moving each by less than this.
const kJitter = 1e-10;
// A point near the origin, so that few points, or points of one plane, have a hull; on no line
// through two of them.
const kInside = [3.1e-4, -4.7e-4, 5.3e-4];

/**
 * Triangles [a, b, c] of the hull of `points` (unit, different from each other) and a point near
 * the origin, counter-clockwise from outside, without those that touch that one. Fewer than three
 * points have none. O(n^2).
 */
export function sphericalHull(points) {
  if (points.length < 3) return [];
  const at = points.map((point, i) => point.map((x, k) => x + kJitter * noise(3 * i + k)));
  at.push(kInside);
  const first = firstTetrahedron(at);
  if (first === null) return [];
  let facets = first.facets;
  for (let i = 0; i < at.length; ++i) {
    if (!first.corners.includes(i)) facets = withPoint(facets, at, i);
  }
  return facets.map(({ corners }) => corners).filter((own) => !own.includes(points.length));
}

// In [0, 1), the same each time.
function noise(i) {
  const hash = Math.imul(i + 1, 0x9e3779b1) ^ Math.imul(i + 7, 0x85ebca6b) >>> 13;
  return (Math.imul(hash, 0xc2b2ae35) >>> 0) / 2 ** 32;
}

function makeFacet(at, a, b, c) {
  return { corners: [a, b, c], origin: at[a],
           normal: normalize(cross(minus(at[b], at[a]), minus(at[c], at[a]))) };
}

const heightOver = ({ origin, normal }, point) =>
  normal[0] * (point[0] - origin[0]) + normal[1] * (point[1] - origin[1]) +
  normal[2] * (point[2] - origin[2]);

// Two points far apart, the one farthest from their line, the one farthest from their plane.
function firstTetrahedron(at) {
  const farthest = (measure) => at.reduce(
    (best, point, i) => (measure(point) > measure(at[best]) ? i : best), 0);
  const a = 0, b = farthest((p) => Math.hypot(...minus(p, at[a])));
  const line = normalize(minus(at[b], at[a]));
  const c = farthest((p) => Math.hypot(...cross(line, minus(p, at[a]))));
  const base = makeFacet(at, a, b, c);
  if (!base.normal.every(Number.isFinite)) return null;
  const d = farthest((p) => Math.abs(heightOver(base, p)));
  const height = heightOver(base, at[d]);
  if (height === 0) return null;
  const [p, q] = height < 0 ? [b, c] : [c, b];
  return { corners: [a, p, q, d],
           facets: [[a, p, q], [a, d, p], [p, d, q], [q, d, a]].map((f) => makeFacet(at, ...f)) };
}

// What the point sees is replaced by triangles between it and the rim of that.
function withPoint(facets, at, i) {
  const kept = [], edges = new Map();
  for (const facet of facets) {
    if (heightOver(facet, at[i]) <= 0) {
      kept.push(facet);
      continue;
    }
    facet.corners.forEach((from, k) => {
      const to = facet.corners[(k + 1) % 3];
      if (!edges.delete(to * at.length + from)) edges.set(from * at.length + to, [from, to]);
    });
  }
  for (const [from, to] of edges.values()) kept.push(makeFacet(at, from, to, i));
  return kept;
}
