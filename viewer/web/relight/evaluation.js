// SPDX-License-Identifier: BSD-3-Clause
// Equation 15 of Yamada 2009 in float64: what a model shows under light.
//
// Light is a vector of a number a direction, `light[channel]`; without a column basis directions
// are the columns.
import { halfTable } from './half_floats.js';

/** The coefficients of a light vector: itself without a column basis. */
export function coefficientsOf(model, light) {
  const basis = model.columnBasis;
  if (basis === null) return light;
  const coefficients = new Float64Array(model.columns);
  for (let j = 0; j < model.columns; ++j) {
    for (let i = basis.first[j]; i < basis.first[j + 1]; ++i) {
      coefficients[j] += basis.value[i] * light[basis.direction[i]];
    }
  }
  return coefficients;
}

/** F I: the product of every basis function with the coefficients. */
export function productsOf(model, coefficients) {
  const halves = halfTable(), { columns, functions, functionExponents } = model;
  // Many lights are dark, and many functions read the rest.
  const lit = [];
  for (let i = 0; i < columns; ++i) if (coefficients[i] !== 0) lit.push(i);
  const products = new Float64Array(functionExponents.length);
  for (let f = 0; f < products.length; ++f) {
    let sum = 0;
    for (const i of lit) sum += halves[functions[f * columns + i]] * coefficients[i];
    products[f] = sum * 2 ** functionExponents[f];
  }
  return products;
}

/** {coefficients, products} of each of the model's channels, under light that `light` holds. */
export function prepareLight(model, light) {
  const prepared = [];
  for (let c = 0; c < model.channels; ++c) {
    // White light is worked out once.
    if (c > 0 && light[c] === light[c - 1]) {
      prepared.push(prepared[c - 1]);
      continue;
    }
    const coefficients = coefficientsOf(model, light[c]);
    prepared.push({ coefficients, products: productsOf(model, coefficients) });
  }
  return prepared;
}

/** What `row` shows with at most `residuals` of its residuals. `prepared`: of its channel. */
export function evaluateRow(model, row, { coefficients, products }, residuals = Infinity) {
  const halves = halfTable(), cluster = model.cluster[row];
  const first = model.clusterFunctions[cluster], weight = model.firstWeight[row];
  let low = 0;
  for (let t = 0; t < model.clusterTerms[cluster]; ++t) {
    low += halves[model.weights[weight + t]] * products[first + t];
  }
  const begin = model.firstResidual[row];
  const end = Math.min(model.firstResidual[row + 1], begin + residuals);
  let sparse = 0;
  for (let i = begin; i < end; ++i) {
    sparse += halves[model.residualValue[i]] * coefficients[model.residualColumn[i]];
  }
  return low * 2 ** model.weightExponent + sparse * 2 ** model.residualExponent;
}
