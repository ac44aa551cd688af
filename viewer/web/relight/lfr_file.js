// SPDX-License-Identifier: BSD-3-Clause
// .lfr bytes -> a model that can be relit. Safe on hostile bytes: memory in proportion to them.
import { ModelError } from '../src/model_error.js';
import {
  areFiniteHalves, halfValue, kLargestHalfExponent, kLeastHalfExponent,
} from './half_floats.js';
import { kHeaderBytes, layoutOf, readHeader } from './lfr_layout.js';
import { xxh3 } from './xxh3.js';

export const kLights = 0, kCubeTexels = 1, kViews = 2; // what a column belongs to

/**
 * The model of a file, whose arrays are views into `bytes` where they can be:
 *
 *   name, kind, points, channels, width, height, columns
 *   directions         Float64Array, x, y, z each, unit, world frame
 *   columnBasis        null, or {first, direction, value}: fields/relightable_model.h
 *   clusterTerms, clusterFunctions   of each cluster: how many functions, and the first of them
 *   functions, functionExponents     float16 bits, `columns` of each; power of two of each
 *   cluster            a row: row = channel * points + point
 *   firstWeight, weights, weightExponent                float16 bits
 *   firstResidual, residualColumn, residualValue, residualExponent    of row r from firstResidual[r]
 *                      to firstResidual[r + 1], largest magnitude first; float16 bits
 *   mostResiduals      that a row has
 *
 * `name` is for messages. Throws ModelError.
 */
export function parseRelightable(bytes, name) {
  const fail = (problem) => { throw new ModelError(`${name}: ${problem}`); };
  const header = readHeader(bytes, fail);
  const layout = layoutOf(header);
  if (header.fileBytes !== layout.fileBytes) fail("the header's sizes contradict each other");
  if (layout.fileBytes !== bytes.length) {
    fail(`the file has ${bytes.length} bytes but should have ${layout.fileBytes}; ` +
         'copy or encode it again');
  }
  if (header.checksum !== xxh3(bytes.subarray(kHeaderBytes))) {
    fail('the content is damaged; copy or encode the file again');
  }
  const section = (key, Type) => arrayOf(bytes, layout.sections[key], Type);
  const model = {
    name: new TextDecoder().decode(section('name', Uint8Array)),
    kind: header.kind, points: header.points, channels: header.channels,
    width: header.width, height: header.height, columns: header.columns,
    directions: section('directions', Float64Array),
    columnBasis: null,
    clusterTerms: section('terms', Uint32Array),
    functionExponents: section('exponents', Int16Array),
    functions: section('functions', Uint16Array),
    cluster: section('clusters', header.clusters <= 256 ? Uint8Array : Uint16Array),
    weights: section('weights', Uint16Array),
    weightExponent: header.weightExponent,
    residualColumn: section('columns', header.columns <= 256 ? Uint8Array : Uint16Array),
    residualValue: section('values', Uint16Array),
    residualExponent: header.residualExponent,
  };
  requireUnit(model.directions, fail);
  if (header.hasColumnBasis === 1) {
    model.columnBasis = readColumnBasis(section, header, fail);
  }
  checkNumbers(model, fail);
  countFunctions(model, header, fail);
  const counts = header.countBytes === 0 ? null
    : section('counts', header.countBytes === 1 ? Uint8Array : Uint16Array);
  countRows(model, counts, header, fail);
  return model;
}

// A view, or a copy where the bytes do not lie as the type wants them.
function arrayOf(bytes, { offset, bytes: length }, Type) {
  const at = bytes.byteOffset + offset;
  if (at % Type.BYTES_PER_ELEMENT === 0) {
    return new Type(bytes.buffer, at, length / Type.BYTES_PER_ELEMENT);
  }
  return new Type(bytes.slice(offset, offset + length).buffer);
}

function requireUnit(directions, fail) {
  for (let i = 0; i < directions.length; i += 3) {
    const length = Math.hypot(directions[i], directions[i + 1], directions[i + 2]);
    if (!(Math.abs(length - 1) <= 1e-6)) fail(`direction ${i / 3} is not of unit length`);
  }
}

function readColumnBasis(section, header, fail) {
  const pairs = section('basisFirst', Uint32Array); // low and high halves
  const first = new Float64Array(header.columns + 1);
  for (let j = 0; j < first.length; ++j) first[j] = pairs[2 * j] + 2 ** 32 * pairs[2 * j + 1];
  const direction = section('basisDirections', Uint32Array);
  const value = section('basisValues', Float32Array);
  if (first[0] !== 0 || first[header.columns] !== header.basisEntries) {
    fail('the tables of its column basis do not fit together');
  }
  for (let j = 0; j < header.columns; ++j) {
    if (first[j + 1] < first[j]) fail('its column basis goes backwards');
  }
  for (let i = 0; i < value.length; ++i) {
    if (direction[i] >= header.directions || !Number.isFinite(value[i])) {
      fail('its column basis has an entry beyond its directions, or not finite');
    }
  }
  return { first, direction, value };
}

function checkNumbers(model, fail) {
  for (const exponent of model.functionExponents) {
    if (exponent < kLeastHalfExponent || exponent > kLargestHalfExponent) {
      fail("a basis function's scale is out of range");
    }
  }
  if (![model.functions, model.weights, model.residualValue].every(areFiniteHalves)) {
    fail('a number is not finite');
  }
  for (const [what, bits, exponent] of [['weight', model.weights, model.weightExponent],
                                        ['residual', model.residualValue, model.residualExponent]]) {
    if (!isInRange(bits, exponent)) fail(`a ${what} is out of the range of float32`);
  }
  for (let f = 0; f < model.functionExponents.length; ++f) {
    const bits = model.functions.subarray(f * model.columns, (f + 1) * model.columns);
    if (!isInRange(bits, model.functionExponents[f])) {
      fail('a basis function is out of the range of float32');
    }
  }
}

function isInRange(bits, exponent) {
  let largest = 0;
  for (let i = 0; i < bits.length; ++i) largest = Math.max(largest, bits[i] & 0x7fff);
  return Number.isFinite(Math.fround(halfValue(largest) * 2 ** exponent));
}

function countFunctions(model, header, fail) {
  model.clusterFunctions = new Float64Array(header.clusters);
  let functions = 0;
  for (let k = 0; k < header.clusters; ++k) {
    model.clusterFunctions[k] = functions;
    functions += model.clusterTerms[k];
  }
  if (functions !== header.functions) fail('its clusters have not the terms that there are');
}

function countRows(model, counts, header, fail) {
  const rows = model.points * model.channels;
  model.firstWeight = new Uint32Array(rows);
  model.firstResidual = new Uint32Array(rows + 1);
  model.mostResiduals = 0;
  // Below 2^32: the file has two bytes of each.
  let weights = 0, residuals = 0;
  for (let row = 0; row < rows; ++row) {
    const cluster = model.cluster[row];
    if (cluster >= header.clusters) fail('a row belongs to a cluster that is not there');
    model.firstWeight[row] = weights;
    weights += model.clusterTerms[cluster];
    if (counts !== null) residuals += counts[row];
    model.firstResidual[row + 1] = residuals;
    if (counts !== null && counts[row] > model.mostResiduals) model.mostResiduals = counts[row];
  }
  if (weights !== header.weights) fail('its rows have not the weights that there are');
  if (residuals !== header.residuals) fail('its rows have not the residuals that there are');
  for (let i = 0; i < residuals; ++i) {
    if (model.residualColumn[i] >= model.columns) fail('a residual lies beyond its columns');
  }
}
