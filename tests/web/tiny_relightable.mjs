// SPDX-License-Identifier: BSD-3-Clause
// Models for relighting of a few pixels, put together here, for tests of what reads them.
import { xxh3 } from '../../viewer/web/relight/xxh3.js';

/** The float16 bits of a number that float16 holds. */
export function halfBits(value) {
  if (value === 0) return 0;
  const sign = value < 0 ? 0x8000 : 0, magnitude = Math.abs(value);
  const exponent = Math.max(-14, Math.floor(Math.log2(magnitude)));
  const mantissa = magnitude / 2 ** exponent * 1024;
  if (!Number.isInteger(mantissa) || exponent > 15) throw new Error(`no float16: ${value}`);
  return sign | (mantissa < 1024 ? mantissa : (exponent + 15 << 10) + (mantissa - 1024));
}

/** A picture of 3 x 2 pixels in three channels under 4 lights; two clusters of 2 and 1 terms. */
export function tinyContent() {
  const rows = 18;
  const content = {
    name: 'tiny', kind: 0, channels: 3, width: 3, height: 2, points: 6, columns: 4,
    directions: [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, 0.8]],
    basis: null, // [[[direction, value], ...] a function]
    terms: [2, 1],
    functionExponents: [0, -1, 2],
    functions: [[1, 0, 0.5, 0.25], [0, -1, 2, 4], [0.125, 0.5, 1, 0]],
    cluster: Array.from({ length: rows }, (_, row) => row % 2),
    weights: [], weightExponent: 1,
    residuals: Array.from({ length: rows }, (_, row) => // [column, value]
      [[row % 4, 0.75], [(row + 1) % 4, -0.5]].slice(0, row % 3)),
    residualExponent: -2,
    positions: 0, triangles: 0, countBytes: 1,
  };
  content.cluster.forEach((own, row) => {
    for (let t = 0; t < content.terms[own]; ++t) content.weights.push((row + 1) / 16 - t / 4);
  });
  return content;
}

/**
 * The .lfr bytes of such content; `edit(head)` may change the head's numbers, {name: value}, before
 * they are written.
 */
export function writeRelightable(content, edit = () => {}) {
  const c = content, wide = c.columns > 256;
  const flat = c.basis?.flat() ?? [];
  const sections = [
    Buffer.from(c.name),
    of(Float64Array, c.directions.flat()),
    of(BigUint64Array, firsts(c.basis)),
    of(Uint32Array, flat.map(([direction]) => direction)),
    of(Float32Array, flat.map(([, value]) => value)),
    Buffer.alloc(12 * c.positions), Buffer.alloc(12 * c.triangles),
    of(Uint32Array, c.terms),
    of(Int16Array, c.functionExponents),
    of(Uint16Array, c.functions.flat().map(halfBits)),
    of(c.terms.length > 256 ? Uint16Array : Uint8Array, c.cluster),
    of(Uint16Array, c.weights.map(halfBits)),
    c.countBytes === 0 ? Buffer.alloc(0)
      : of(c.countBytes === 1 ? Uint8Array : Uint16Array, c.residuals.map((own) => own.length)),
    of(wide ? Uint16Array : Uint8Array, c.residuals.flat().map(([column]) => column)),
    of(Uint16Array, c.residuals.flat().map(([, value]) => halfBits(value))),
  ].map((bytes) => Buffer.concat([bytes, Buffer.alloc((8 - bytes.length % 8) % 8)]));
  const body = Buffer.concat(sections);
  const head = {
    version: 1, kind: c.kind, channels: c.channels, width: c.width, height: c.height,
    columns: c.columns, points: c.points, directions: c.directions.length,
    clusters: c.terms.length, functions: c.functions.length, weights: c.weights.length,
    residuals: c.residuals.flat().length, entries: flat.length, positions: c.positions,
    triangles: c.triangles, weightExponent: c.weightExponent,
    residualExponent: c.residualExponent, nameBytes: Buffer.byteLength(c.name),
    hasBasis: c.basis === null ? 0 : 1, countBytes: c.countBytes, zero: 0,
    fileBytes: 136 + body.length,
  };
  edit(head);
  return withChecksums(Buffer.concat([headBytes(head), body]));
}

/** The same bytes, with the check sums that they should have. */
export function withChecksums(bytes) {
  const whole = Buffer.from(bytes);
  whole.writeBigUInt64LE(xxh3(whole.subarray(136)), 120);
  whole.writeBigUInt64LE(xxh3(whole.subarray(0, 128)), 128);
  return whole;
}

function headBytes(h) {
  const head = Buffer.alloc(136);
  head.write('LFMRFL\r\n', 'latin1');
  [h.version, h.kind, h.channels, h.width, h.height, h.columns].forEach((value, i) =>
    head.writeUInt32LE(value, 8 + 4 * i));
  head.writeBigUInt64LE(BigInt(h.points), 32);
  head.writeUInt32LE(h.directions, 40);
  head.writeUInt32LE(h.clusters, 44);
  [h.functions, h.weights, h.residuals, h.entries, h.positions, h.triangles].forEach((value, i) =>
    head.writeBigUInt64LE(BigInt(value), 48 + 8 * i));
  head.writeInt32LE(h.weightExponent, 96);
  head.writeInt32LE(h.residualExponent, 100);
  head.writeUInt32LE(h.nameBytes, 104);
  head.writeUInt8(h.hasBasis, 108);
  head.writeUInt8(h.countBytes, 109);
  head.writeUInt16LE(h.zero, 110);
  head.writeBigUInt64LE(BigInt(h.fileBytes), 112);
  return head;
}

function of(Type, values) {
  const typed = Type === BigUint64Array ? Type.from(values, BigInt) : Type.from(values);
  return Buffer.from(typed.buffer, typed.byteOffset, typed.byteLength);
}

function firsts(basis) {
  if (basis === null) return [];
  const first = [0];
  for (const own of basis) first.push(first.at(-1) + own.length);
  return first;
}

/** R of the content as dense rows over the directions, worked out the long way. */
export function denseRows(content) {
  let weight = 0;
  const firstFunction = content.terms.map((_, k) =>
    content.terms.slice(0, k).reduce((sum, terms) => sum + terms, 0));
  return content.cluster.map((cluster, row) => {
    const columns = Array(content.columns).fill(0);
    for (let t = 0; t < content.terms[cluster]; ++t, ++weight) {
      const f = firstFunction[cluster] + t;
      columns.forEach((_, i) => {
        columns[i] += content.weights[weight] * 2 ** content.weightExponent *
          content.functions[f][i] * 2 ** content.functionExponents[f];
      });
    }
    for (const [column, value] of content.residuals[row]) {
      columns[column] += value * 2 ** content.residualExponent;
    }
    if (content.basis === null) return columns;
    const directions = Array(content.directions.length).fill(0);
    content.basis.forEach((entries, j) => {
      for (const [direction, value] of entries) directions[direction] += columns[j] * value;
    });
    return directions;
  });
}
