// SPDX-License-Identifier: BSD-3-Clause
// The browser viewer's readers and camera, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { boundsOf } from '../../viewer/web/src/bounds.js';
import { decodeBc1, decodeBc4Planes } from '../../viewer/web/src/block_decoding.js';
import { GlbSource } from '../../viewer/web/src/glb_source.js';
import { rankByTerms, readLightField, viewMapAt } from '../../viewer/web/src/light_field.js';
import { ModelError } from '../../viewer/web/src/model_error.js';
import {
  eyeOf, frame, lookAt, orbit, pan, withDistance, zoom,
} from '../../viewer/web/src/orbit_camera.js';
import { readPngSize } from '../../viewer/web/src/page_decoding.js';
import { readSettings } from '../../viewer/web/src/view_settings.js';
import { buildGlb, buildPng, tinyModel } from './tiny_model.mjs';

const read = async (bytes) => readLightField(await GlbSource.fromBytes(bytes, 'm.glb'));

const fails = (promise, expected) => assert.rejects(promise, (error) => {
  assert.ok(error instanceof ModelError, String(error.stack));
  assert.match(error.message, expected);
  assert.ok(error.message.startsWith('m.glb: ') && !error.message.includes('\n'));
  return true;
});

// Seeded: the same damage each time.
function makeRandom(seed) {
  let state = seed;
  return (below) => {
    state = Math.imul(state, 1664525) + 1013904223 >>> 0;
    return Math.floor(state / 2 ** 32 * below);
  };
}

test('GlbSource: every prefix is refused', async () => {
  const whole = tinyModel();
  await read(whole);
  for (let length = 0; length < whole.length; ++length) {
    await fails(read(whole.subarray(0, length)), /cut off|shorter or longer|not a GLB/);
  }
  await fails(read(Buffer.concat([whole, Buffer.alloc(4)])), /shorter or longer/);
});

test('GlbSource: a stream gives buffer views as they arrive', async () => {
  const whole = tinyModel();
  let controller;
  const stream = new ReadableStream({ start: (c) => { controller = c; } });
  const opening = GlbSource.fromStream(stream, 'm.glb');
  const jsonEnd = 28 + whole.readUInt32LE(12);
  for (const byte of whole.subarray(0, jsonEnd)) controller.enqueue(Uint8Array.of(byte));
  const source = await opening;
  const { byteOffset, byteLength } = source.json.bufferViews[0];
  let arrived = false;
  const first = source.bufferView(0).then((bytes) => { arrived = true; return bytes; });
  const end = jsonEnd + byteOffset + byteLength;
  controller.enqueue(whole.subarray(jsonEnd, end - 1));
  await new Promise((resolve) => setTimeout(resolve, 5));
  assert.ok(!arrived && !source.whole);
  controller.enqueue(whole.subarray(end - 1, end));
  assert.deepEqual(Buffer.from(await first), whole.subarray(jsonEnd + byteOffset, end));
  const reading = readLightField(source);
  controller.enqueue(whole.subarray(end));
  controller.close();
  assert.equal((await reading).triangleCount, 2);
});

test('GlbSource: a stream that ends or breaks early says so', async () => {
  const whole = tinyModel();
  const cut = new Blob([whole.subarray(0, whole.length - 20)]).stream();
  await fails(GlbSource.fromStream(cut, 'm.glb').then(readLightField), /cut off|shorter/);
  const broken = new ReadableStream({
    start: (controller) => {
      controller.enqueue(whole.subarray(0, 100));
      setTimeout(() => controller.error(new TypeError('network')), 5);
    },
  });
  await fails(GlbSource.fromStream(broken, 'm.glb').then(readLightField), /connection broke/);
});

test('GlbSource: a claimed size takes no memory', async () => {
  const whole = Buffer.from(tinyModel());
  whole.writeUInt32LE(0xfffffff0, 8);
  whole.writeUInt32LE(0xfffffff0 - whole.readUInt32LE(12) - 28, 20 + whole.readUInt32LE(12));
  let controller;
  const stream = new ReadableStream({ start: (c) => { controller = c; } });
  controller.enqueue(new Uint8Array(whole));
  const source = await GlbSource.fromStream(stream, 'm.glb');
  assert.ok(source.arriving.bytes.length <= 1 << 20);
  source.json.bufferViews[0].byteLength = 2 ** 31;
  controller.close();
  await fails(source.bufferView(0), /cut off/);
});

test('GlbSource: buffer views lie inside the file', async () => {
  for (const [key, value] of [['byteOffset', -4], ['byteOffset', 1e9], ['byteLength', 1e9],
                              ['byteLength', -1], ['byteLength', 0.5], ['byteLength', '12'],
                              ['byteOffset', 2 ** 53], ['buffer', 1]]) {
    const source = await GlbSource.fromBytes(tinyModel(), 'm.glb');
    source.json.bufferViews[3][key] = value;
    await fails(readLightField(source), /outside the file/);
  }
  await fails(read(buildGlb([], Buffer.alloc(4))), /not a light field model/);
  await fails(read(buildGlb({ extensions: 3 }, Buffer.alloc(4))), /not a light field model/);
});

test('readLightField: what a file means', async () => {
  const field = await read(tinyModel());
  assert.equal(field.terms, 1);
  assert.deepEqual([...field.axes.subarray(0, 9)], [1, 0, 0, 0, 1, 0, 0, 0, 1]);
  // A quarter turn round z: x becomes y.
  const turned = [0, 1, 0, -1, 0, 0, 0, 0, 1];
  field.axes.subarray(27).forEach((value, i) => assert.ok(Math.abs(value - turned[i]) < 1e-6));
  assert.deepEqual([...field.viewMaps[0]], [0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0, 4, 0, 4, 0, 4]);
  assert.deepEqual(field.needs, {
    mean: [{ width: 6, height: 5 }], surface: [[{ width: 6, height: 5 }]],
    view: [[{ width: 8, height: 8 }]],
  });
});

const kBroken = {
  'an unknown version': [({ extension }) => { extension.version = 5; }, /version/],
  'no extension': [({ json }) => { delete json.extensions; }, /not a light field model/],
  'too many terms': [({ extension }) => { extension.terms = 1e9; }, /terms/],
  'terms that are not whole': [({ extension }) => { extension.terms = 0.5; }, /terms/],
  'a huge grid': [({ extension }) => { extension.grid = 1e9; }, /grid/],
  'a huge tile layout': [({ extension }) => { extension.viewTilesPerPage = 2 ** 31 - 1; }, /no place/],
  'an unknown direction map': [({ extension }) => { extension.directionMap = 'x'; }, /directionMap/],
  'a NaN vertex': [({ arrays }) => { arrays.vertices[0][4] = NaN; }, /not a number/],
  'an infinite vertex': [({ arrays }) => { arrays.vertices[0][4] = Infinity; }, /not a number/],
  'a vertex far away': [({ arrays }) => { arrays.vertices[0][4] = 1e30; }, /too far/],
  'a corner that is not there': [({ arrays }) => { arrays.triangles[0][4] = 4; }, /not there/],
  'corners that are no triangle': [({ arrays }) => { arrays.triangles[0] = new Uint32Array(4); },
                                   /no triangle/],
  'no triangle': [({ arrays }) => { arrays.triangles[0] = new Uint32Array(0); }, /no triangle/],
  'a frame of length 2': [({ arrays }) => { arrays.frames[0][3] = 2; }, /unit quaternion/],
  'too few frames': [({ arrays }) => { arrays.frames[0] = arrays.frames[0].slice(4); }, /length/],
  'a vertex with more terms': [({ arrays }) => { arrays.vertexTerms[0][1] = 2; }, /more terms/],
  'an infinite range': [({ arrays }) => { arrays.viewRanges[0][1] = -Infinity; }, /not a number/],
  'a large range': [({ arrays }) => { arrays.viewRanges[0][0] = 1e9; }, /too large/],
  'a patch on no page': [({ arrays }) => { arrays.placements[0][4] = 1; }, /patch/],
  'a flipped patch left of its page': [({ arrays }) => { arrays.placements[0][5] = 1; }, /patch/],
  'a patch of one sample': [({ arrays }) => { arrays.placements[0][3] = 2; }, /patch/],
  'a patch far right': [({ arrays }) => { arrays.placements[0][1] = 65535; }, /patch/],
  'tiles on no page': [({ extension }) => { extension.viewTilesPerPage = 2; }, /tile/],
  'no list of pages': [({ extension }) => { extension.surfaceImages = []; }, /one entry a term/],
  'an image that is not there': [({ extension }) => { extension.viewImages = [[9]]; }, /image/],
  'a string for an accessor': [({ extension }) => { extension.frames = '3'; }, /frames/],
  'an accessor of another form': [({ extension }) => { extension.frames = 0; }, /another form/],
  'codebooks of nothing': [({ extension }) => { extension.meanCodebook = null; }, /"surfaceCodebooks"/],
  'an odd block page': [({ extension }) => {
    extension.blocks = { surfaceFormat: 'bc1', mean: [{ bufferView: 0, width: 6, height: 4 }] };
  }, /do not fill/],
};

for (const [what, [edit, expected]] of Object.entries(kBroken)) {
  test(`readLightField: refuses ${what}`, () => fails(read(tinyModel(edit)), expected));
}

test('readLightField: a huge count is refused before anything is made', async () => {
  const source = await GlbSource.fromBytes(tinyModel(), 'm.glb');
  source.json.accessors[0].count = 2 ** 30;
  await fails(readLightField(source), /longer than its buffer view/);
});

test('readLightField: damaged bytes give a model or a ModelError', async () => {
  const random = makeRandom(7);
  const whole = tinyModel();
  const jsonBytes = whole.readUInt32LE(12);
  for (let round = 0; round < 3000; ++round) {
    const bytes = Buffer.from(whole);
    const within = round % 2 === 0 ? [0, 20 + jsonBytes] : [20 + jsonBytes, whole.length];
    for (let i = 0; i <= round % 4; ++i) {
      bytes[within[0] + random(within[1] - within[0])] = random(256);
    }
    await read(bytes).catch((error) => {
      if (!(error instanceof ModelError)) throw error;
    });
  }
});

test('view maps with grids of their own', () => {
  const field = { grid: 8, viewTilesPerRow: 2, viewTilesPerPage: 4 };
  const counts = [1, 2, 3]; // 1 map, 8 maps, 48 maps
  assert.deepEqual(viewMapAt(field, counts, 0), [0, 0, 0, 8]);
  assert.deepEqual(viewMapAt(field, counts, 1), [8, 0, 0, 4]);
  assert.deepEqual(viewMapAt(field, counts, 4), [12, 4, 0, 4]);
  assert.deepEqual(viewMapAt(field, counts, 5), [0, 8, 0, 4]);
  assert.deepEqual(viewMapAt(field, counts, 9), [8, 8, 0, 2]);
  assert.deepEqual(viewMapAt(field, counts, 9 + 16 + 5), [2, 2, 1, 2]);
  assert.deepEqual(viewMapAt(field, null, 7), [8, 8, 1, 8]);
  assert.deepEqual([...rankByTerms(Uint8Array.of(0, 2, 1, 2, 0), 2)], [3, 0, 2, 1, 4]);
});

test('decodeBc1: integers as docs/formats.md says', () => {
  // Ends (255, 0, 0) and (0, 0, 255), in both orders; texels take 0, 1, 2, 3 in each row.
  const four = decodeBc1(Uint8Array.of(0x00, 0xf8, 0x1f, 0x00, 0xe4, 0xe4, 0xe4, 0xe4), 4, 4);
  assert.deepEqual([...four.subarray(0, 16)],
                   [255, 0, 0, 255, 0, 0, 255, 255, 170, 0, 84, 255, 85, 0, 169, 255]);
  assert.deepEqual(four.subarray(48, 64), four.subarray(0, 16));
  const three = decodeBc1(Uint8Array.of(0x1f, 0x00, 0x00, 0xf8, 0xe4, 0xe4, 0xe4, 0xe4), 4, 4);
  assert.deepEqual([...three.subarray(8, 16)], [128, 0, 128, 255, 0, 0, 0, 255]);
  const two = new Uint8Array(16).fill(0);
  two.set([0xff, 0xff], 8); // the second block is white
  const page = decodeBc1(two, 8, 4);
  assert.deepEqual([page[0], page[16], page[3], page[4 * 24]], [0, 255, 255, 0]);
});

test('decodeBc4Planes: integers as docs/formats.md says', () => {
  // Codes 0 to 7, twice: 24 bits each half, least significant first.
  const indices = [0x88, 0xc6, 0xfa, 0x88, 0xc6, 0xfa];
  const bytes = Uint8Array.of(255, 0, ...indices, 0, 255, ...indices, 9, 9, ...indices);
  const texels = decodeBc4Planes(bytes, 4, 4);
  const plane = (c) => Array.from({ length: 8 }, (_, i) => texels[4 * i + c]);
  const between = (a, b, m, k) => a + Math.floor((b - a) * Math.floor(Math.floor(16320 / m) * k / 64) / 256);
  assert.deepEqual(plane(0), [255, 0, ...[1, 2, 3, 4, 5, 6].map((k) => between(255, 0, 7, k))]);
  assert.deepEqual(plane(1), [0, 255, ...[1, 2, 3, 4].map((k) => between(0, 255, 5, k)), 0, 255]);
  assert.deepEqual(plane(2), [9, 9, 9, 9, 9, 9, 0, 255]);
  assert.equal(texels[4 * 8], 255); // the lower half begins again
});

test('readPngSize: 8-bit RGB alone', () => {
  const png = buildPng(5, 3);
  assert.deepEqual(readPngSize(png), { width: 5, height: 3 });
  assert.equal(readPngSize(png.subarray(0, 32)), null);
  for (const [at, value] of [[0, 0], [12, 0], [24, 16], [25, 6]]) {
    const other = Buffer.from(png);
    other[at] = value;
    assert.equal(readPngSize(other), null);
  }
});

test('the camera: frames, turns and stays within its limits', () => {
  const bounds = boundsOf(Float32Array.of(-3, 0, 0, 3, 0, 0, 0, 4, 2));
  assert.deepEqual(bounds.center, [0, 2, 1]);
  const fov = 0.5;
  for (const aspect of [0.5, 2]) {
    const camera = frame(bounds, fov, aspect);
    // The sphere's outline against the shorter side's half, as tangents.
    const tangent = bounds.radius / Math.sqrt(camera.distance ** 2 - bounds.radius ** 2);
    assert.ok(Math.abs(tangent / (Math.tan(fov / 2) * Math.min(1, aspect)) - 0.92) < 1e-9);
  }
  const camera = frame(bounds, fov, 1);
  const eye = eyeOf(orbit({ ...camera, azimuth: 0, elevation: 0 }, Math.PI / 2, 0));
  assert.ok(Math.abs(eye[1] - camera.target[1] - camera.distance) < 1e-9);
  assert.ok(orbit(camera, 0, 9).elevation < Math.PI / 2);
  assert.ok(Math.abs(orbit(camera, -20 * Math.PI, 0).azimuth - camera.azimuth) < 1e-9);
  assert.equal(zoom(camera, 1e9).distance, camera.maxDistance);
  for (const bad of [NaN, Infinity, 0, -1]) assert.equal(zoom(camera, bad).distance, camera.distance);
  assert.equal(orbit(camera, NaN, NaN).azimuth, camera.azimuth);
  assert.equal(withDistance(camera, 1).minDistance, 1);
  const far = lookAt(camera, [1000, 2, 1]);
  assert.ok(Math.abs(far.target[0] - bounds.radius) < 1e-9);
  // Seen along -y with x to the right: what is dragged right and down takes the target left and up.
  const front = orbit({ ...camera, azimuth: 0, elevation: 0 }, -Math.PI / 2, 0);
  const moved = pan(front, 1, 1, 100);
  const step = 2 * camera.distance * Math.tan(fov / 2) / 100;
  assert.ok(Math.abs(moved.target[0] - front.target[0] + step) < 1e-9);
  assert.ok(Math.abs(moved.target[2] - front.target[2] - step) < 1e-9);
});

test('settings: what makes no sense is left out', () => {
  const settings = readSettings('#azimuth=30&fov=1000&terms=x&width=&background=%23FF0080&__proto__=3');
  assert.deepEqual([settings.azimuth, settings.fov, settings.terms, settings.width], [30, 30, undefined, undefined]);
  assert.equal(settings.background, 'ff0080');
  assert.equal(readSettings('').elevation, 25);
});
