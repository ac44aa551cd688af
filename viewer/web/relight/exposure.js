// SPDX-License-Identifier: BSD-3-Clause
// What linear radiance is to be multiplied with, so that a picture is bright and little is white.
import { evaluateRow, prepareLight } from './evaluation.js';

const kPixels = 1500; // that are looked at
const kShare = 0.92; // of the pixels that are not dark
const kShown = 0.65; // is what that one becomes, linear
const kDark = 1e-3; // of the brightest

/** Under each of `lights` (evaluation.js), the brightest counts. 1 where all is black. */
export function gainFor(model, lights) {
  const count = Math.min(model.points, kPixels);
  const brightest = new Float64Array(count);
  for (const light of lights) {
    const prepared = prepareLight(model, light);
    for (let i = 0; i < count; ++i) {
      const point = Math.floor((i + 0.5) * model.points / count);
      prepared.forEach((own, c) => {
        brightest[i] = Math.max(brightest[i], evaluateRow(model, c * model.points + point, own));
      });
    }
  }
  brightest.sort();
  const lit = brightest.filter((value) => value > kDark * brightest[count - 1]);
  const level = lit[Math.floor(kShare * (lit.length - 1))] ?? 0;
  return level > 0 && Number.isFinite(kShown / level) ? kShown / level : 1;
}
