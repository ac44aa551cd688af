// SPDX-License-Identifier: BSD-3-Clause
// What the shaders look up a vertex and a triangle, in float textures kTableWidth entries wide
// (viewer/gl_light_field_maps.h says which entry holds what).
import { DataTexture, FloatType, RGBAFormat } from 'three';

export const kTableWidth = 1024;

function tableTexture(count, write) {
  const rows = Math.max(1, Math.ceil(count / kTableWidth));
  const entries = new Float32Array(4 * rows * kTableWidth);
  write(entries);
  const texture = new DataTexture(entries, kTableWidth, rows, RGBAFormat, FloatType);
  texture.needsUpdate = true;
  return texture;
}

/** {frames, ranges, patches, tiles} of a light field (light_field.js). */
export function makeTableTextures(field) {
  const { terms, vertexCount, triangleCount } = field;
  return {
    frames: tableTexture(3 * vertexCount, (entries) => writeFrames(field, entries)),
    ranges: tableTexture(terms * vertexCount, (entries) => writeRanges(field, entries)),
    patches: tableTexture((terms + 1) * triangleCount, (entries) => writePatches(field, entries)),
    tiles: tableTexture(terms * vertexCount, (entries) => {
      field.viewMaps.forEach((places, k) => entries.set(places, 4 * k * vertexCount));
    }),
  };
}


function writeFrames(field, entries) {
  for (let v = 0; v < field.vertexCount; ++v) {
    for (let axis = 0; axis < 3; ++axis) {
      const from = 9 * v + 3 * axis;
      entries.set(field.axes.subarray(from, from + 3), 12 * v + 4 * axis);
      // The desktop's x entry has the vertex's view tile; here `tiles` tells, of every model.
      entries[12 * v + 4 * axis + 3] = axis === 0 ? 0 : field.vertexTerms[v];
    }
  }
}

// Corners without a term have ranges of 0, so that whatever lies in its maps adds nothing.
function writeRanges(field, entries) {
  for (let v = 0; v < field.vertexCount; ++v) {
    for (let k = 0; k < field.vertexTerms[v]; ++k) {
      const range = k * field.vertexCount + v;
      entries[4 * range] = field.surfaceRanges[2 * range];
      entries[4 * range + 1] = field.surfaceRanges[2 * range + 1];
      entries[4 * range + 2] = field.viewRanges[2 * range];
      entries[4 * range + 3] = field.viewRanges[2 * range + 1];
    }
  }
}

function writePatches(field, entries) {
  let to = 0;
  for (let layer = 0; layer <= field.terms; ++layer) {
    const placements = field.placements[field.codebooks ? layer : 0];
    for (let i = 0; i < placements.length; i += 4, to += 4) {
      const last = (placements[i + 3] >> 1) - 1;
      entries[to] = placements[i + 1];
      entries[to + 1] = placements[i + 2];
      entries[to + 2] = placements[i];
      entries[to + 3] = placements[i + 3] & 1 ? -last : last;
    }
  }
}
