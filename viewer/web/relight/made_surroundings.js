// SPDX-License-Identifier: BSD-3-Clause
// Surroundings that are worked out, not photographed: radiance of a direction in the upright frame
// (right, up, front: towards the viewer's side).
import { paintMap } from './surroundings.js';
import { dot, normalize } from './vectors.js';

const mix = (a, b, t) => a.map((value, c) => value + t * (b[c] - value));
const clamp01 = (x) => Math.max(0, Math.min(1, x));
const smooth = (from, to, x) => {
  const t = clamp01((x - from) / (to - from));
  return t * t * (3 - 2 * t);
};

/** A light of `width` x `height` (tangents of half angles) round `toward`, upright: 1 in it. */
function panel(direction, toward, width, height, edge = 0.03) {
  const depth = dot(direction, toward);
  if (depth <= 0) return 0;
  const right = normalize([-toward[2], 0, toward[0]]);
  const up = [right[1] * toward[2] - right[2] * toward[1], right[2] * toward[0] - right[0] * toward[2],
              right[0] * toward[1] - right[1] * toward[0]];
  const across = Math.abs(dot(direction, right)) / depth;
  const along = Math.abs(dot(direction, up)) / depth;
  return (1 - smooth(width - edge, width + edge, across)) *
    (1 - smooth(height - edge, height + edge, along));
}

const kSun = normalize([0.55, 0.62, 0.56]);

function sky(direction) {
  const [, up] = direction;
  const ground = [0.16, 0.13, 0.1];
  if (up < -0.02) return ground;
  const towardSun = Math.max(0, dot(direction, kSun));
  const blue = mix([0.75, 0.82, 0.9], [0.13, 0.28, 0.62], smooth(0, 0.7, up));
  const haze = 0.5 * towardSun ** 8;
  const lit = blue.map((value, c) => value + haze * [1, 0.85, 0.6][c]);
  const disc = smooth(Math.cos(0.075), Math.cos(0.045), towardSun);
  return mix(ground, lit, smooth(-0.02, 0.02, up)).map((value, c) =>
    value + disc * [330, 300, 240][c]);
}

function studio(direction) {
  const [, up] = direction;
  const walls = 0.02 + 0.02 * clamp01(up);
  const key = panel(direction, normalize([-0.8, 0.6, 0.75]), 0.4, 0.4);
  const fill = panel(direction, normalize([1, 0.15, 0.35]), 0.25, 0.75);
  const rim = panel(direction, normalize([0.35, 0.75, -0.85]), 0.6, 0.12);
  return [0, 1, 2].map((c) => walls + key * [9, 8.4, 7.4][c] + fill * [1.1, 1.5, 2.1][c] +
    rim * [5, 5, 5.4][c]);
}

const kWindow = normalize([-0.95, 0.3, 0.3]);

function room(direction) {
  const depth = dot(direction, kWindow);
  const [, up] = direction;
  const walls = mix([0.05, 0.04, 0.035], [0.09, 0.085, 0.08], clamp01(up + 0.3));
  const warm = panel(direction, normalize([0.7, -0.05, 0.72]), 0.08, 0.1) * 6;
  let pane = panel(direction, kWindow, 0.42, 0.6);
  if (pane > 0) {
    const right = normalize([-kWindow[2], 0, kWindow[0]]);
    const across = dot(direction, right) / depth, along = (up - depth * kWindow[1]) / depth;
    const bar = (x, at) => smooth(0.02, 0.035, Math.abs(x - at));
    pane *= bar(across, 0) * bar(along, 0.2) * bar(along, -0.2);
  }
  const outside = mix([5, 6, 5], [11, 14, 18], smooth(0.1, 0.5, up));
  return walls.map((value, c) => value + pane * outside[c] + warm * [1, 0.7, 0.4][c]);
}

const kMade = {
  sky: { title: 'Sun and sky', radiance: sky, samples: 4 },
  studio: { title: 'Studio', radiance: studio, samples: 2 },
  window: { title: 'A window', radiance: room, samples: 2 },
};

/** {name: title} of all that can be made. */
export const madeTitles = Object.fromEntries(
  Object.entries(kMade).map(([name, { title }]) => [name, title]));

/** The map (surroundings.js) of that name. */
export function makeSurroundings(name) {
  const { radiance, samples } = kMade[name];
  return paintMap(radiance, samples);
}
