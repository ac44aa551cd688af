// SPDX-License-Identifier: BSD-3-Clause
// Models of a few vertices, put together here, for tests of the readers.
import { deflateSync } from 'node:zlib';

export const kExtension = 'LFM_surface_light_field';
const kComponents = new Map([[Uint8Array, 5121], [Uint16Array, 5123], [Uint32Array, 5125],
                             [Float32Array, 5126]]);

function chunk(type, content) {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(content.length, 0);
  head.writeUInt32LE(type, 4);
  return Buffer.concat([head, content]);
}

const pad = (bytes, filler) =>
  Buffer.concat([bytes, Buffer.alloc((4 - bytes.length % 4) % 4, filler)]);

export function buildGlb(json, binary) {
  const chunks = Buffer.concat([
    chunk(0x4e4f534a, pad(Buffer.from(JSON.stringify(json)), ' ')),
    chunk(0x004e4942, pad(binary, 0)),
  ]);
  const head = Buffer.alloc(12);
  head.write('glTF');
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([head, chunks]);
}

/** An 8-bit RGB PNG (no check sums: nothing here reads them). */
export function buildPng(width, height) {
  const part = (type, content) => {
    const bytes = Buffer.alloc(12 + content.length);
    bytes.writeUInt32BE(content.length, 0);
    bytes.write(type, 4);
    content.copy(bytes, 8);
    return bytes;
  };
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), part('IHDR', header),
    part('IDAT', deflateSync(Buffer.alloc((3 * width + 1) * height))), part('IEND', Buffer.alloc(0)),
  ]);
}

/**
 * Two triangles in a square of 10 mm, one term, patches of 3 samples a side, view maps of 4 x 4.
 * `edit` may change {json, extension} and the arrays before they are written.
 */
export function tinyModel(edit = () => {}) {
  const arrays = {
    vertices: [new Float32Array([0, 0, 0, 10, 0, 0, 0, 10, 0, 10, 10, 0]), 'VEC3'],
    triangles: [new Uint32Array([0, 1, 2, 1, 3, 2]), 'SCALAR'],
    frames: [new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, Math.SQRT1_2, Math.SQRT1_2]),
             'VEC4'],
    vertexTerms: [new Uint8Array([1, 0, 1, 1]), 'SCALAR'],
    placements: [new Uint16Array([0, 1, 1, 6, 0, 5, 4, 7]), 'VEC4'],
    surfaceRanges: [new Float32Array([1, -0.5, 1, -0.5, 1, -0.5, 1, -0.5]), 'VEC2'],
    viewRanges: [new Float32Array([1, 0, 1, 0, 1, 0, 1, 0]), 'VEC2'],
  };
  const extension = {
    version: 3, terms: 1, grid: 4, directionMap: 'hemi-octahedral', meanImages: [0],
    surfaceImages: [[1]], viewImages: [[2]], viewTilesPerRow: 2, viewTilesPerPage: 4,
  };
  const json = { asset: { version: '2.0' }, accessors: [], bufferViews: [], images: [],
                 extensions: { [kExtension]: extension } };
  const pictures = [[7, 6], [7, 6], [8, 8]];
  edit({ json, extension, arrays, pictures });
  const parts = [];
  let length = 0;
  const view = (bytes) => {
    json.bufferViews.push({ buffer: 0, byteOffset: length, byteLength: bytes.length });
    parts.push(pad(Buffer.from(bytes), 0));
    length += parts.at(-1).length;
    return json.bufferViews.length - 1;
  };
  for (const [width, height] of pictures) {
    json.images.push({ bufferView: view(buildPng(width, height)), mimeType: 'image/png' });
  }
  const shapes = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
  for (const [name, [values, type]] of Object.entries(arrays)) {
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    json.accessors.push({ bufferView: view(bytes), componentType: kComponents.get(values.constructor),
                          count: values.length / shapes[type], type });
    if (!(name in extension)) extension[name] = json.accessors.length - 1;
  }
  json.buffers = [{ byteLength: length }];
  return buildGlb(json, Buffer.concat(parts));
}
