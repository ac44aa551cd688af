// SPDX-License-Identifier: BSD-3-Clause
// A model as the textures hold it: rows by pixel, weights and residuals in groups of four.

import { ModelError } from '../src/model_error.js';

const kGroup = 4;
const kMostTerms = 65535;

/**
 * {rows, weights, residuals}:
 *
 *   rows       Uint32Array, four numbers a row of the model: where its weights begin, in groups;
 *              its first basis function; where its residuals begin, in groups; how many of each,
 *              terms in the lower 16 bits
 *   weights    Uint16Array of float16 bits, filled up with zeros to groups
 *   residuals  Uint32Array, the value's float16 bits below, the column above
 *
 * Throws ModelError when a cluster has more than 65535 terms.
 */
export function makeTables(model) {
  if (model.clusterTerms.some((terms) => terms > kMostTerms)) {
    throw new ModelError('the model has more terms than a page can show; encode it with fewer');
  }
  const rowCount = model.cluster.length;
  const rows = new Uint32Array(4 * rowCount);
  let weightGroups = 0, residualGroups = 0;
  for (let row = 0; row < rowCount; ++row) {
    const cluster = model.cluster[row], terms = model.clusterTerms[cluster];
    const residuals = model.firstResidual[row + 1] - model.firstResidual[row];
    rows[4 * row] = weightGroups;
    rows[4 * row + 1] = model.clusterFunctions[cluster];
    rows[4 * row + 2] = residualGroups;
    rows[4 * row + 3] = terms | residuals << 16;
    weightGroups += Math.ceil(terms / kGroup);
    residualGroups += Math.ceil(residuals / kGroup);
  }
  const weights = new Uint16Array(kGroup * weightGroups);
  const residuals = new Uint32Array(kGroup * residualGroups);
  for (let row = 0; row < rowCount; ++row) {
    const from = model.firstWeight[row], terms = model.clusterTerms[model.cluster[row]];
    weights.set(model.weights.subarray(from, from + terms), kGroup * rows[4 * row]);
    const begin = model.firstResidual[row], end = model.firstResidual[row + 1];
    for (let i = begin, to = kGroup * rows[4 * row + 2]; i < end; ++i, ++to) {
      residuals[to] = model.residualColumn[i] << 16 | model.residualValue[i];
    }
  }
  return { rows, weights, residuals };
}
