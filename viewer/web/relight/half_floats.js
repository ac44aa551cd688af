// SPDX-License-Identifier: BSD-3-Clause
// float16 with a power of two in common, as fields/half_floats.h: value = half * 2^exponent.

export const kLeastHalfExponent = -170;
export const kLargestHalfExponent = 120;

/** The number of these 16 bits; infinities and NaN pass. */
export function halfValue(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = bits >> 10 & 31, mantissa = bits & 0x3ff;
  if (exponent === 31) return mantissa === 0 ? sign * Infinity : NaN;
  if (exponent === 0) return sign * mantissa * 2 ** -24;
  return sign * (1024 + mantissa) * 2 ** (exponent - 25);
}

/** Of every 16 bits: 256 KiB, made when it is first asked for. */
export function halfTable() {
  table ??= Float32Array.from({ length: 65536 }, (_, bits) => halfValue(bits));
  return table;
}
let table = null;

/** Whether all are numbers (neither infinities nor NaN). */
export function areFiniteHalves(bits) {
  for (let i = 0; i < bits.length; ++i) {
    if ((bits[i] & 0x7c00) === 0x7c00) return false;
  }
  return true;
}
