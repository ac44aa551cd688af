// SPDX-License-Identifier: BSD-3-Clause
// Scenes of several models in the browser viewer, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { boundsOf, boundsTogether, placedPart } from '../../viewer/web/src/bounds.js';
import { ModelError } from '../../viewer/web/src/model_error.js';
import { eyeOf, frame, withLimitsOf, zoom } from '../../viewer/web/src/orbit_camera.js';
import { kWhereItIs, worldFromModel } from '../../viewer/web/src/placement.js';
import { parseScene } from '../../viewer/web/src/scene_description.js';
import { UploadQueue } from '../../viewer/web/src/upload_queue.js';

const kTurned = { position: [100, 0, 5], quaternion: [0, 0, Math.SQRT1_2, Math.SQRT1_2], scale: 2 };

test('a placement scales, then turns, then moves', () => {
  const out = [0, 0, 0];
  worldFromModel(kTurned)(3, 4, 1, out); // a quarter turn round z: x becomes y
  [92, 6, 7].forEach((value, i) => assert.ok(Math.abs(out[i] - value) < 1e-12));
  worldFromModel(kWhereItIs)(0.1, -1e9, 1 / 3, out);
  assert.deepEqual(out, [0.1, -1e9, 1 / 3]);
});

test('bounds of a scene are those of one mesh of all its vertices', () => {
  const vertices = Float32Array.from({ length: 300 }, (_, i) => (i * i * 7919 + 31 * i) % 1009 / 10);
  const places = [kWhereItIs, kTurned, { ...kTurned, position: [-50, 30, 0], scale: 0.1 }];
  const all = places.flatMap((place) => {
    const toWorld = worldFromModel(place), points = [];
    for (let i = 0; i < vertices.length; i += 3) {
      const out = [0, 0, 0];
      toWorld(vertices[i], vertices[i + 1], vertices[i + 2], out);
      points.push(...out);
    }
    return points;
  });
  const parts = places.map((place) => placedPart(vertices, place));
  const { closest, ...together } = boundsTogether(parts);
  assert.deepEqual(together, boundsOf(all));
  assert.equal(closest, Math.min(...parts.map(({ bounds }) => bounds.radius)));
  const { closest: own, ...one } = boundsTogether(parts.slice(0, 1));
  assert.deepEqual(one, boundsOf(vertices));
  assert.equal(own, one.radius);
  assert.equal(boundsTogether([placedPart(Float32Array.of(1, 2, 3), kTurned)]).radius, 1);
});

test('the camera in a scene: near to its smallest part, and where it is as the scene grows', () => {
  const small = boundsOf(Float32Array.of(0, 0, 0, 2, 0, 0));
  const large = { ...boundsOf(Float32Array.of(0, 0, 0, 2000, 0, 0)), closest: 1 };
  const camera = zoom(frame(large, 0.5, 1), 1e-9);
  assert.equal(camera.distance, 1.05);
  const before = zoom(frame(small, 0.5, 1), 2);
  const after = withLimitsOf(before, frame(large, 0.5, 1));
  assert.deepEqual(eyeOf(after), eyeOf(before));
  assert.equal(after.radius, 1000);
  assert.equal(zoom(after, 1e9).distance, frame(large, 0.5, 1).maxDistance);
});

test('parseScene: what a scene means', () => {
  const scene = parseScene(JSON.stringify({ models: [
    { file: 'model.glb' },
    { file: 'model-2.glb', translation: [1, 2, 3], rotation: [0.5005, 0.5005, 0.5005, -0.5005], scale: 1e-6 },
    { file: 'model.glb', rotation: [-1, 0, 0, 0] },
  ] }), 's');
  assert.deepEqual(scene.map(({ file }) => file), ['model.glb', 'model-2.glb']);
  assert.deepEqual(scene[0].places, [kWhereItIs, { ...kWhereItIs, quaternion: [0, 0, 0, -1] }]);
  const [{ position, quaternion, scale }] = scene[1].places;
  assert.deepEqual([position, scale], [[1, 2, 3], 1e-6]);
  [0.5, 0.5, -0.5, 0.5].forEach((value, i) => assert.ok(Math.abs(quaternion[i] - value) < 1e-12));
});

const one = (properties) => JSON.stringify({ models: [{ file: 'model.glb', ...properties }] });
const kBrokenScenes = {
  'nothing': ['', /damaged/],
  'half of a scene': [one({}).slice(0, -3), /damaged/],
  'a number': ['3', /no scene/],
  'a list': ['[]', /no scene/],
  'null': ['null', /no scene/],
  'another key': ['{"models": [], "camera": 1}', /no scene/],
  'no models': ['{}', /no model/],
  'an empty list': ['{"models": []}', /no model/],
  'models that are no list': ['{"models": {"length": 1}}', /no model/],
  'too many models': [JSON.stringify({ models: Array(1001).fill({ file: 'm' }) }), /more than 1000/],
  'a huge text': [' '.repeat(5e6), /larger/],
  'null for a model': ['{"models": [null]}', /models\[0\] is no object/],
  'no file': ['{"models": [{}]}', /file/],
  'a file that is no text': [one({ file: ['model.glb'] }), /file/],
  'no name': [one({ file: '' }), /file/],
  'a file elsewhere': [one({ file: '//elsewhere/model.glb' }), /file/],
  'a file above': [one({ file: 'a/../../model.glb' }), /file/],
  'a name of two lines': [one({ file: 'a\nb' }), /file/],
  'a long name': [one({ file: 'a'.repeat(300) }), /file/],
  'an unknown key': [one({ position: [0, 0, 0] }), /unknown key/],
  'a prototype': ['{"models": [{"file": "m", "__proto__": {"scale": 2}}]}', /unknown key/],
  'two coordinates': [one({ translation: [0, 0] }), /translation/],
  'text for a coordinate': [one({ translation: [0, 0, '1'] }), /translation/],
  'null for a coordinate': [one({ translation: [0, 0, NaN] }), /translation/],
  'null for a translation': [one({ translation: null }), /translation/],
  'an infinite coordinate': ['{"models": [{"file": "m", "translation": [0, 0, 1e999]}]}', /translation/],
  'a place far away': [one({ translation: [0, 2e9, 0] }), /1e9/],
  'no rotation': [one({ rotation: [0, 0, 0, 0] }), /unit/],
  'a rotation of length 2': [one({ rotation: [2, 0, 0, 0] }), /unit/],
  'a rotation of three': [one({ rotation: [1, 0, 0] }), /rotation/],
  'scale 0': [one({ scale: 0 }), /scale/],
  'a mirror': [one({ scale: -1 }), /scale/],
  'text for a scale': [one({ scale: '1' }), /scale/],
  'null for a scale': [one({ scale: null }), /scale/],
  'an infinite scale': ['{"models": [{"file": "m", "scale": 1e999}]}', /scale/],
};

for (const [what, [text, expected]] of Object.entries(kBrokenScenes)) {
  test(`parseScene: refuses ${what}`, () => {
    assert.throws(() => parseScene(text, 's.json'), (error) => {
      assert.ok(error instanceof ModelError, String(error.stack));
      assert.match(error.message, expected);
      assert.ok(error.message.startsWith('s.json: ') && !error.message.includes('\n'));
      return true;
    });
  });
}

/** A model of `terms` terms with one page each; notes in `sent` what is sent of it. */
function fakeObject(name, terms, sent, { breaksAt = Infinity } = {}) {
  return {
    loadedTerms: -1,
    maps: { queue: Array.from({ length: terms + 1 }, (_, k) => k), texelsWaiting: 2 ** 24 },
    changes: 0,
    noteChange() { ++this.changes; },
    uploadPage() {
      const k = this.maps.queue.shift();
      sent.push(`${name}${k}`);
      if (k >= breaksAt) this.queue.remove(this);
      else this.loadedTerms = k;
    },
  };
}

test('UploadQueue: mean views first, then term by term over all models', async () => {
  const sent = [];
  const renderer = { info: { render: { frame: 0 } },
                     getContext: () => ({ getParameter: () => 0, pixelStorei() {} }) };
  const queue = new UploadQueue();
  const objects = [fakeObject('a', 3, sent), fakeObject('b', 1, sent),
                   fakeObject('c', 3, sent, { breaksAt: 1 })];
  for (const object of objects) {
    object.queue = queue;
    queue.add(object);
  }
  assert.ok(queue.full);
  const done = queue.until(() => objects[0].loadedTerms === 3);
  for (; renderer.info.render.frame < 20; ++renderer.info.render.frame) queue.upload(renderer);
  await done;
  assert.deepEqual(sent, ['a0', 'b0', 'c0', 'a1', 'b1', 'c1', 'a2', 'a3']);
  assert.ok(objects.every(({ changes }) => changes > 0));
  queue.remove(objects[0]);
  assert.ok(!queue.full);
});

test('UploadQueue: one share a draw, however many objects are drawn', () => {
  const sent = [];
  const renderer = { info: { render: { frame: 7 } },
                     getContext: () => ({ getParameter: () => 0, pixelStorei() {} }) };
  const queue = new UploadQueue();
  const object = fakeObject('a', 1, sent);
  object.maps.queue = [0];
  queue.add(object);
  queue.upload(renderer);
  object.maps.queue = [1];
  queue.upload(renderer);
  assert.deepEqual(sent, ['a0']);
  ++renderer.info.render.frame;
  queue.upload(renderer);
  assert.deepEqual(sent, ['a0', 'a1']);
});
