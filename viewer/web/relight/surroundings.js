// SPDX-License-Identifier: BSD-3-Clause
// Light from all around: radiance over the sphere, as a picture of longitude and latitude.
//
// Column u of the picture, 0 to 1 from the left, lies `(u - 0.5) 360` degrees to the right of what
// is behind the object; the top row is up.
import { ModelError } from '../src/model_error.js';
import { readRadiancePicture } from './radiance_picture.js';

export const kMapWidth = 256;
export const kMapHeight = 128;

/** In the upright frame (view_frame.js): right, up, front. */
export function directionOfMap(u, v) {
  const longitude = (2 * u - 1) * Math.PI, polar = v * Math.PI;
  const flat = Math.sin(polar);
  return [flat * Math.sin(longitude), Math.cos(polar), -flat * Math.cos(longitude)];
}

/** [u, v] of a direction in the upright frame. */
export const mapOfDirection = ([right, up, front]) => [
  0.5 + Math.atan2(right, -front) / (2 * Math.PI),
  Math.acos(Math.max(-1, Math.min(1, up))) / Math.PI,
];

/** Solid angle of a texel in row `y`: 4 pi over the picture. */
export const solidAngleOfRow = (y) => 2 * Math.PI / kMapWidth *
  (Math.cos(y * Math.PI / kMapHeight) - Math.cos((y + 1) * Math.PI / kMapHeight));

/** Float32Array of r, g, b each; the mean of `samples` x `samples` places a texel. */
export function paintMap(radiance, samples = 3) {
  const map = new Float32Array(3 * kMapWidth * kMapHeight);
  for (let i = 0; i < kMapWidth * kMapHeight * samples * samples; ++i) {
    const sample = i % (samples * samples), texel = Math.floor(i / (samples * samples));
    const x = texel % kMapWidth + (sample % samples + 0.5) / samples;
    const y = Math.floor(texel / kMapWidth) + (Math.floor(sample / samples) + 0.5) / samples;
    const color = radiance(directionOfMap(x / kMapWidth, y / kMapHeight));
    for (let c = 0; c < 3; ++c) map[3 * texel + c] += color[c] / (samples * samples);
  }
  return map;
}

/**
 * A Radiance picture of longitude and latitude as such a map: each texel the mean over its area,
 * whatever the picture's size. Throws ModelError.
 */
export function readMap(bytes, name) {
  const map = new Float64Array(3 * kMapWidth * kMapHeight);
  readRadiancePicture(bytes, name, (y, row, { width, height }) => {
    if (y === 0 && Math.abs(width - 2 * height) > 0.02 * width) {
      throw new ModelError(`${name}: ${width} x ${height} pixels; ` +
                           'a picture of all directions is twice as wide as high');
    }
    const line = shrinkRow(row, width);
    for (const { to, share } of overlaps(y, height, kMapHeight)) {
      for (let i = 0; i < line.length; ++i) map[line.length * to + i] += share * line[i];
    }
  });
  // Each texel got the areas that it covers, in pixels of the map: 1 in all.
  return Float32Array.from(map);
}

// Which texels of `count` an interval of `from` ones covers, and how much of each.
function overlaps(index, from, count) {
  const begin = index * count / from, end = (index + 1) * count / from;
  const found = [];
  for (let to = Math.floor(begin); to < Math.min(count, Math.ceil(end)); ++to) {
    const share = Math.min(end, to + 1) - Math.max(begin, to);
    if (share > 0) found.push({ to, share });
  }
  return found;
}

function shrinkRow(row, width) {
  const line = new Float64Array(3 * kMapWidth);
  for (let x = 0; x < width; ++x) {
    for (const { to, share } of overlaps(x, width, kMapWidth)) {
      for (let c = 0; c < 3; ++c) line[3 * to + c] += share * row[3 * x + c];
    }
  }
  return line;
}
