// SPDX-License-Identifier: BSD-3-Clause
// The cube map whose texels' middles are given: column = (face N + y) N + x.
import { add, cross, dot, minus, normalize, scale, vectorAt } from './vectors.js';

const kGrid_abs = 1e-5;

/**
 * {resolution, faces: [{normal, right, down}]}: in which order the faces come and how they turn is
 * read from the directions themselves. Null when they are no cube's.
 */
export function lightCubeOf(directions) {
  const resolution = Math.round(Math.sqrt(directions.length / 18));
  if (resolution < 1 || directions.length !== 18 * resolution ** 2) return null;
  const faces = [];
  for (let face = 0; face < 6; ++face) faces.push(faceOf(directions, face, resolution));
  const cube = { resolution, faces };
  for (let i = 0; i < directions.length / 3; ++i) {
    const direction = vectorAt(directions, i), place = placeIn(cube, direction);
    const x = i % resolution, y = Math.floor(i / resolution) % resolution;
    const isThere = place.face === Math.floor(i / resolution ** 2) &&
      Math.abs(place.x - x) < kGrid_abs * resolution && Math.abs(place.y - y) < kGrid_abs * resolution;
    if (!isThere) return null;
  }
  return cube;
}

function faceOf(directions, face, n) {
  const at = (x, y) => vectorAt(directions, (face * n + y) * n + x);
  let sum = [0, 0, 0];
  for (let i = 0; i < n * n; ++i) sum = add(sum, at(i % n, Math.floor(i / n)));
  const normal = normalize(sum);
  if (n === 1) {
    const other = Math.abs(normal[0]) > 0.5 ? [0, 1, 0] : [1, 0, 0];
    const right = normalize(cross(other, normal));
    return { normal, right, down: cross(normal, right) };
  }
  const onPlane = (x, y) => scale(at(x, y), 1 / dot(at(x, y), normal));
  const corner = onPlane(0, 0);
  return { normal, right: normalize(minus(onPlane(n - 1, 0), corner)),
           down: normalize(minus(onPlane(0, n - 1), corner)) };
}

/** Face, and place on it in texels: whole numbers are middles. */
function placeIn({ resolution, faces }, direction) {
  let face = 0;
  for (let f = 1; f < 6; ++f) {
    if (dot(faces[f].normal, direction) > dot(faces[face].normal, direction)) face = f;
  }
  const { normal, right, down } = faces[face];
  const depth = dot(normal, direction);
  const place = (axis) => (dot(axis, direction) / depth + 1) / 2 * resolution - 0.5;
  return { face, x: place(right), y: place(down) };
}

/** The column of the texel that holds `direction`. */
export function texelOf(cube, direction) {
  const n = cube.resolution, { face, x, y } = placeIn(cube, direction);
  const whole = (value) => Math.max(0, Math.min(n - 1, Math.round(value)));
  return (face * n + whole(y)) * n + whole(x);
}

/** [{index, share}]: the texels round `direction` on its face, bilinear. */
export function texelsRound(cube, direction) {
  const n = cube.resolution, { face, x, y } = placeIn(cube, direction);
  const along = (value) => {
    const clamped = Math.max(0, Math.min(n - 1, value)), low = Math.min(Math.floor(clamped), n - 1);
    const share = clamped - low;
    return share > 0 ? [[low, 1 - share], [low + 1, share]] : [[low, 1]];
  };
  return along(y).flatMap(([row, a]) =>
    along(x).map(([column, b]) => ({ index: (face * n + row) * n + column, share: a * b })));
}

/** Of a texel: those of a cube sum to 4 pi. */
export function solidAngleOf({ resolution: n }, column) {
  const x = column % n, y = Math.floor(column / n) % n;
  const corner = (i, j) => {
    const a = 2 * i / n - 1, b = 2 * j / n - 1;
    return Math.atan2(a * b, Math.sqrt(a * a + b * b + 1));
  };
  return corner(x + 1, y + 1) - corner(x, y + 1) - corner(x + 1, y) + corner(x, y);
}
