// SPDX-License-Identifier: BSD-3-Clause
// Reads and checks the extension LFM_surface_light_field (docs/formats.md, "The model"): geometry,
// tables, and which buffer views hold the pages. Trusts nothing.
import { GltfDocument, kUint8, kUint16, kUint32 } from './gltf_document.js';
import { readPageLists } from './page_lists.js';
import { measureNeeds } from './page_needs.js';

export const kExtension = 'LFM_surface_light_field';
export const kMostTerms = 16; // of the shader's arrays

const kOldestVersion = 2, kNewestVersion = 4;
const kDirectionMaps = ['hemi-octahedral', 'orthographic', 'hemi-octahedral-skirt'];
const kMaxSide = 16384;
const kMostTiles = 2 ** 26;
const kAnyIndex = 2 ** 31 - 1;
const kMaxCoordinate = 1e12; // mm; squares stay finite in single precision
const kMaxRange = 1e6; // of a map's values; products stay finite

/**
 * Reads all but the pages. `source`: {json, name, bufferView(index)}. The result:
 *
 *   name, terms (K), meanInTerms, grid, directionMap (0, 1, 2), vertexCount (V), triangleCount (T)
 *   vertices          Float32Array, 3 V: mm, world frame, z up
 *   triangles         Uint32Array, 3 T
 *   axes              Float32Array, 9 V: x, y and z axis of each vertex's frame
 *   vertexTerms       Uint8Array, V
 *   placements        Uint16Arrays of 4 T: page, x, y, 2 n + flipped; of the mean view, and where
 *                     surface maps lie by themselves (`codebooks`) K more
 *   viewMaps          K Int32Arrays of 4 V: x, y, page, grid of each vertex's view map; of vertices
 *                     without the term all 0
 *   surfaceRanges, viewRanges  Float32Array, 2 K V: scale, bias
 *   pages, needs      see page_lists.js, page_needs.js
 *
 * Throws ModelError when something does not fit.
 */
export async function readLightField(source) {
  const doc = new GltfDocument(source);
  const extension = source.json.extensions?.[kExtension];
  doc.require(extension !== null && typeof extension === 'object',
              `no extension ${kExtension}: not a light field model`);
  const field = readHead(doc, extension);
  field.pages = readPageLists(doc, extension, field.terms);
  await readMesh(doc, extension, field);
  await Promise.all([readFrames(doc, extension, field), readTerms(doc, extension, field)]);
  await readPlacements(doc, extension, field);
  await readViewMaps(doc, extension, field);
  field.needs = measureNeeds(doc, field);
  return field;
}

function readHead(doc, extension) {
  doc.integer(extension.version, '"version"', kOldestVersion, kNewestVersion);
  const directionMap = kDirectionMaps.indexOf(extension.directionMap);
  doc.require(directionMap >= 0, '"directionMap" is not known');
  const meanInTerms = extension.meanInTerms ?? false;
  doc.require(typeof meanInTerms === 'boolean', '"meanInTerms" is not true or false');
  const field = {
    name: doc.source.name,
    terms: doc.integer(extension.terms, '"terms"', 0, kMostTerms),
    meanInTerms,
    grid: doc.integer(extension.grid, '"grid"', 2, 256),
    directionMap,
    viewTilesPerRow: doc.integer(extension.viewTilesPerRow, '"viewTilesPerRow"', 1, kMaxSide),
    viewTilesPerPage: doc.integer(extension.viewTilesPerPage, '"viewTilesPerPage"', 1, kAnyIndex),
  };
  const rows = Math.floor((field.viewTilesPerPage - 1) / field.viewTilesPerRow) + 1;
  doc.require(field.viewTilesPerRow * field.grid <= 2 ** 20 && rows * field.grid <= 2 ** 21,
              'its view tiles have no place');
  return field;
}

async function readMesh(doc, extension, field) {
  const [vertices, triangles] = await Promise.all([
    doc.floats(extension.vertices, 'vertices', 'VEC3'),
    doc.accessor(extension.triangles, 'triangles', [kUint32], 'SCALAR'),
  ]);
  field.vertexCount = vertices.length / 3;
  field.triangleCount = triangles.length / 3;
  doc.require(triangles.length > 0 && triangles.length % 3 === 0, 'the mesh has no triangle');
  doc.require(vertices.every((value) => Math.abs(value) <= kMaxCoordinate),
              'a vertex lies too far away');
  doc.require(triangles.every((vertex) => vertex < field.vertexCount),
              'a triangle names a vertex that is not there');
  field.vertices = vertices;
  field.triangles = triangles;
}

async function readFrames(doc, extension, field) {
  const frames = await doc.floats(extension.frames, 'frames', 'VEC4', field.vertexCount);
  field.axes = new Float32Array(9 * field.vertexCount);
  for (let v = 0; v < field.vertexCount; ++v) {
    const q = frames.subarray(4 * v, 4 * v + 4);
    const norm = Math.hypot(q[0], q[1], q[2], q[3]);
    doc.require(Math.abs(norm - 1) < 1e-3, 'a vertex frame is not a unit quaternion');
    const x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
    field.axes.set([
      1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
      2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
      2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y),
    ], 9 * v);
  }
}

async function readTerms(doc, extension, field) {
  field.vertexTerms = await doc.accessor(extension.vertexTerms, 'vertexTerms', [kUint8], 'SCALAR',
                                         field.vertexCount);
  doc.require(field.vertexTerms.every((terms) => terms <= field.terms),
              'a vertex has more terms than the model');
  field.surfaceRanges = field.viewRanges = new Float32Array(0);
  if (field.terms === 0) return;
  const read = async (key) => {
    const ranges = await doc.floats(extension[key], key, 'VEC2', field.terms * field.vertexCount);
    for (let i = 0; i < ranges.length; i += 2) {
      doc.require(ranges[i] >= 0 && ranges[i] <= kMaxRange && Math.abs(ranges[i + 1]) <= kMaxRange,
                  'the range of a map is negative or too large');
    }
    return ranges;
  };
  [field.surfaceRanges, field.viewRanges] =
    await Promise.all([read('surfaceRanges'), read('viewRanges')]);
}

async function readIndices(doc, index, what, count, most) {
  const indices = await doc.accessor(index, what, [kUint16, kUint32], 'SCALAR', count);
  doc.require(indices.every((value) => value < most), 'an index into a codebook is out of range');
  return indices;
}

// A placement a triangle.
async function readCodebook(doc, value, field) {
  const codebook = doc.object(value, 'a codebook');
  const codes = await doc.accessor(codebook.placements, 'placements', [kUint16], 'VEC4');
  const indices = await readIndices(doc, codebook.indices, 'indices', field.triangleCount,
                                    codes.length / 4);
  const placements = new Uint16Array(4 * field.triangleCount);
  for (let t = 0; t < field.triangleCount; ++t) {
    for (let i = 0; i < 4; ++i) placements[4 * t + i] = codes[4 * indices[t] + i];
  }
  return placements;
}

async function readPlacements(doc, extension, field) {
  field.codebooks = 'meanCodebook' in extension && field.terms > 0;
  if (!('meanCodebook' in extension)) {
    field.placements = [await doc.accessor(extension.placements, 'placements', [kUint16], 'VEC4',
                                           field.triangleCount)];
    return;
  }
  const codebooks = [extension.meanCodebook];
  if (field.codebooks) {
    codebooks.push(...doc.list(extension.surfaceCodebooks, '"surfaceCodebooks"', field.terms));
  }
  field.placements = await Promise.all(codebooks.map((value) => readCodebook(doc, value, field)));
}

// How many maps the counts of a term hold.
function countMaps(doc, counts, grid) {
  doc.list(counts, 'an entry of "viewTileCounts"');
  doc.require(counts.length === 3, 'an entry of "viewTileCounts" is not a list of three');
  let maps = 0;
  counts.forEach((count, level) => {
    doc.integer(count, 'an entry of "viewTileCounts"', 0, kMostTiles);
    doc.require(count === 0 || (grid % (1 << level) === 0 && grid >> level >= 2),
                'its view maps do not fill its view tiles');
    maps += count * 4 ** level;
  });
  return maps;
}

async function readViewMaps(doc, extension, field) {
  if (!field.codebooks) {
    const ranks = rankByTerms(field.vertexTerms, field.terms);
    field.viewMaps = Array.from({ length: field.terms },
                                (_, k) => placeViewMaps(field, k, ranks, null));
    return;
  }
  const lists = doc.list(extension.viewIndices, '"viewIndices"', field.terms);
  const numbers = await Promise.all(lists.map(
    (index) => readIndices(doc, index, 'viewIndices', field.vertexCount, kAnyIndex)));
  const counts = 'viewTileCounts' in extension
    ? doc.list(extension.viewTileCounts, '"viewTileCounts"', field.terms) : null;
  field.viewMaps = numbers.map((list, k) => {
    if (counts !== null) {
      const maps = countMaps(doc, counts[k], field.grid);
      doc.require(list.every((number, v) => field.vertexTerms[v] <= k || number < maps),
                  'its view maps do not fill its view tiles');
    }
    return placeViewMaps(field, k, list, counts?.[k] ?? null);
  });
}

/** Each vertex's place when those with more terms come first, among equals the lower index. */
export function rankByTerms(vertexTerms, mostTerms) {
  const next = new Int32Array(mostTerms + 1);
  for (const terms of vertexTerms) {
    for (let fewer = 0; fewer < terms; ++fewer) ++next[fewer];
  }
  return Int32Array.from(vertexTerms, (terms) => next[terms]++);
}

/** x, y, page and grid of view map `number`; `counts`: tiles of each grid, or null. */
export function viewMapAt(field, counts, number) {
  let tile = number, grid = field.grid, x = 0, y = 0;
  if (counts !== null) {
    let level = 0, first = 0, within = number;
    while (level + 1 < counts.length && within >= counts[level] * 4 ** level) {
      within -= counts[level] * 4 ** level;
      first += counts[level++];
    }
    const side = 1 << level;
    grid = field.grid >> level;
    tile = first + Math.floor(within / (side * side));
    x = within % side * grid;
    y = Math.floor(within / side) % side * grid;
  }
  const inPage = tile % field.viewTilesPerPage;
  return [
    inPage % field.viewTilesPerRow * field.grid + x,
    Math.floor(inPage / field.viewTilesPerRow) * field.grid + y,
    Math.floor(tile / field.viewTilesPerPage),
    grid,
  ];
}

function placeViewMaps(field, term, numbers, counts) {
  const places = new Int32Array(4 * field.vertexCount);
  for (let v = 0; v < field.vertexCount; ++v) {
    if (field.vertexTerms[v] > term) places.set(viewMapAt(field, counts, numbers[v]), 4 * v);
  }
  return places;
}
