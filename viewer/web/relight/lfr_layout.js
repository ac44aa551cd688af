// SPDX-License-Identifier: BSD-3-Clause
// The head of a .lfr file and where its sections lie (docs/formats.md), as
// fields/relightable_layout.cpp.
import { kLargestHalfExponent, kLeastHalfExponent } from './half_floats.js';
import { xxh3 } from './xxh3.js';

export const kHeaderBytes = 136;
const kVersion = 1;
const kMagic = [0x4c, 0x46, 0x4d, 0x52, 0x46, 0x4c, 0x0d, 0x0a]; // "LFMRFL\r\n"
const kMostEntries = 2 ** 40;

/** Whether the bytes begin as a .lfr file does. */
export const isRelightable = (bytes) => kMagic.every((byte, i) => bytes[i] === byte);

/** The head's numbers by name. `fail(problem)` throws. */
export function readHeader(bytes, fail) {
  if (!isRelightable(bytes)) fail('not a model for relighting (.lfr)');
  if (bytes.length < kHeaderBytes) fail('the file is cut short; copy or encode it again');
  const view = new DataView(bytes.buffer, bytes.byteOffset, kHeaderBytes);
  const u32 = (at) => view.getUint32(at, true), u64 = (at) => Number(view.getBigUint64(at, true));
  const version = u32(8);
  if (version !== kVersion) {
    fail(`a model of version ${version}; this page reads version ${kVersion}`);
  }
  if (view.getBigUint64(128, true) !== xxh3(bytes.subarray(0, 128))) {
    fail('the header is damaged; copy or encode the file again');
  }
  const header = {
    kind: u32(12), channels: u32(16), width: u32(20), height: u32(24), columns: u32(28),
    points: u64(32), directions: u32(40), clusters: u32(44), functions: u64(48), weights: u64(56),
    residuals: u64(64), basisEntries: u64(72), positions: u64(80), triangles: u64(88),
    weightExponent: view.getInt32(96, true), residualExponent: view.getInt32(100, true),
    nameBytes: u32(104), hasColumnBasis: bytes[108], countBytes: bytes[109],
    zero: view.getUint16(110, true), fileBytes: u64(112), checksum: view.getBigUint64(120, true),
  };
  const problem = problemOf(header);
  if (problem !== null) fail(`the header says ${problem}`);
  return header;
}

const isExponent = (e) => e >= kLeastHalfExponent && e <= kLargestHalfExponent;

function problemOf(h) {
  if (h.kind > 2) return 'columns of an unknown kind';
  if (h.channels !== 1 && h.channels !== 3) return `${h.channels} channels; it must be 1 or 3`;
  if (h.points < 1 || h.points > 2 ** 36) return `${h.points} points; it must be 1 to 2^36`;
  if (h.columns < 1 || h.columns > 65536) return `${h.columns} columns; it must be 1 to 65536`;
  if (h.directions < 1 || h.directions > 2 ** 24) {
    return `${h.directions} directions; it must be 1 to 2^24`;
  }
  if (h.clusters < 1 || h.clusters > 65536) return `${h.clusters} clusters; it must be 1 to 65536`;
  if ([h.functions, h.weights, h.residuals, h.basisEntries, h.triangles].some((n) =>
    n > kMostEntries)) {
    return 'a table of more than 2^40 entries';
  }
  if (h.positions !== 0 && h.positions !== h.points) return 'positions of some of its points only';
  if (h.nameBytes > 4096) return 'a name of more than 4096 bytes';
  if (!isExponent(h.weightExponent) || !isExponent(h.residualExponent)) {
    return 'a scale out of range';
  }
  if (h.hasColumnBasis > 1 || h.countBytes > 2 || h.zero !== 0 ||
      (h.countBytes === 0 && h.residuals > 0) || (h.hasColumnBasis === 0 && h.basisEntries > 0)) {
    return 'marks that contradict each other';
  }
  if ((h.width === 0) !== (h.height === 0) || h.width > 65536 || h.height > 65536 ||
      (h.width > 0 && h.width * h.height !== h.points)) {
    return `a picture of ${h.width} x ${h.height} pixels for ${h.points} points`;
  }
  if (h.hasColumnBasis === 0 && h.columns !== h.directions) {
    return `${h.directions} directions for ${h.columns} columns`;
  }
  return null;
}

/** Of a header without a problem: {sections: {name: {offset, bytes}}, fileBytes}. */
export function layoutOf(h) {
  const rows = h.points * h.channels;
  const sizes = {
    name: h.nameBytes,
    directions: 24 * h.directions,
    basisFirst: h.hasColumnBasis ? 8 * (h.columns + 1) : 0,
    basisDirections: 4 * h.basisEntries,
    basisValues: 4 * h.basisEntries,
    positions: 12 * h.positions,
    triangles: 12 * h.triangles,
    terms: 4 * h.clusters,
    exponents: 2 * h.functions,
    functions: h.functions * 2 * h.columns,
    clusters: rows * (h.clusters <= 256 ? 1 : 2),
    weights: 2 * h.weights,
    counts: rows * h.countBytes,
    columns: h.residuals * (h.columns <= 256 ? 1 : 2),
    values: 2 * h.residuals,
  };
  const sections = {};
  let offset = kHeaderBytes;
  for (const [name, bytes] of Object.entries(sizes)) {
    sections[name] = { offset, bytes };
    offset += 8 * Math.ceil(bytes / 8);
  }
  return { sections, fileBytes: offset };
}
