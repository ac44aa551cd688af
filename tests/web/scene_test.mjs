// SPDX-License-Identifier: BSD-3-Clause
// Pages of several models, in Chromium with software GL.
//
// Of the samples (pages.mjs), the folder scene holds the pages that WriteWebFolder wrote of a scene,
// and scene.png, scene,azimuth=75,terms=2.png, ...: what the reference renderer shows of it. All
// other models are spheres of one place and size.
import assert from 'node:assert/strict';
import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { pictureOf, serve, stateOf } from './browser.mjs';
import {
  hashOf, kBackground, kBare, messageOf, openPage, sample, samples, sceneFile,
  sceneFolder, singleFile, startBrowser, stopBrowser, web,
} from './pages.mjs';
import { comparePictures, decodePng } from './png.mjs';

// dB over the foreground. A direction to the eye that is not the turned model's own gives 28.
const kLeastPsnr = 40;
const kSamePsnr = 50; // between pictures of one renderer
const kCenter = [10, -20, 80], kRadius = 60; // of the models' spheres
const kWidth = 640, kHeight = 480;
const kLeft = { translation: [-150, 0, 0] }, kRight = { translation: [150, 0, 0] };
const kFromFront = { ...kBare, azimuth: 270, elevation: 0 }; // x to the right

before(startBrowser);
after(stopBrowser);

const sceneOf = (...models) => JSON.stringify({ models });
const pixelsOf = async (page) => decodePng(await pictureOf(page));

/** A page of `files` ({name: sample}) that stand as `models` say: on the disk, all shown. */
async function openScene(models, files, settings = kFromFront) {
  const bytes = await bytesOf(files);
  const opened = await openPage(await sceneFile(sceneOf(...models), bytes), settings);
  assert.equal(opened.state.error, null);
  assert.deepEqual(opened.complaints, []);
  return opened;
}

async function bytesOf(files) {
  const entries = Object.entries(files).map(async ([file, name]) => [file, await sample(name)]);
  return Object.fromEntries(await Promise.all(entries));
}

async function pictureOfScene(models, files, settings) {
  const { page, close } = await openScene(models, files, settings);
  const picture = await pixelsOf(page);
  await close();
  return picture;
}

/** Columns `from` to `to` of a picture. */
function columns({ width, height, rgb }, from, to) {
  const part = new Uint8Array(3 * (to - from) * height);
  for (let y = 0; y < height; ++y) {
    part.set(rgb.subarray(3 * (y * width + from), 3 * (y * width + to)), 3 * y * (to - from));
  }
  return { width: to - from, height, rgb: part };
}
const leftHalf = (picture) => columns(picture, 0, kWidth / 2);
const rightHalf = (picture) => columns(picture, kWidth / 2, kWidth);

function assertSame(picture, reference, what) {
  const { psnr, outside, count } = comparePictures(picture, reference, kBackground);
  assert.ok(count > 500, `${what}: ${count} pixels show something`);
  assert.ok(psnr >= kSamePsnr, `${what}: ${psnr} dB`);
  assert.ok(outside < count / 500, `${what}: ${outside} pixels outside`);
}

function assertDifferent(picture, reference, what) {
  const { psnr } = comparePictures(picture, reference, kBackground);
  assert.ok(psnr < 35, `${what}: ${psnr} dB`);
}

const written = path.join(samples, 'scene');
const references = (await readdir(written)).filter((name) => name.endsWith('.png'));

async function compareWithReferences({ page }) {
  assert.ok(references.length > 0);
  for (const file of references) {
    const own = Object.fromEntries(file.slice(0, -4).split(',').slice(1)
      .map((part) => part.split('=')));
    await page.evaluate((hash) => { window.location.hash = hash; },
                        hashOf({ ...kBare, terms: 16, ...own }));
    await page.waitForTimeout(50); // hashchange comes later
    const reference = decodePng(await readFile(path.join(written, file)));
    const found = comparePictures(await pixelsOf(page), reference, kBackground);
    console.log(`${file}: ${found.psnr.toFixed(2)} dB, largest difference ${found.largest}`);
    assert.ok(found.psnr >= kLeastPsnr, `${file}: ${found.psnr} dB`);
    assert.ok(found.outside < found.count / 500, `${file}: ${found.outside} pixels outside`);
  }
}

test('a scene in a single file from the disk shows what the reference shows', async () => {
  const opened = await openPage(pathToFileURL(path.join(written, 'model.html')).href, kBare);
  const { error, loadedTerms, terms, times } = opened.state;
  assert.equal(error, null);
  assert.deepEqual([loadedTerms, terms], [3, 3]);
  assert.ok(times.modelOpen <= times.tablesRead && times.meanShown <= times.allShown);
  await compareWithReferences(opened);
  assert.deepEqual(opened.complaints, []);
  assert.deepEqual(await opened.page.evaluate(() => window.violations), []);
  assert.equal(opened.requests.length, 1);
  await opened.close();
});

test('a scene in a folder on a server: each file once, then what the reference shows', async () => {
  const names = ['app.js', 'model-2.glb', 'model-3.glb', 'model.glb', 'scene.json'];
  const files = names.map((name) => [`/${name}`, path.join(written, name)]);
  const url = await serve({ '/': path.join(written, 'index.html'), ...Object.fromEntries(files) },
                          { slowly: 5000 });
  const opened = await openPage(url, kBare);
  const { error, loadedTerms, terms, times } = opened.state;
  assert.equal(error, null);
  assert.deepEqual([loadedTerms, terms], [3, 3]);
  assert.ok(times.meanShown < times.allShown);
  await compareWithReferences(opened);
  assert.deepEqual(opened.complaints, []);
  assert.deepEqual(await opened.page.evaluate(() => window.violations), []);
  assert.deepEqual(opened.requests.map((request) => new URL(request).pathname).sort(),
                   ['/', ...names.map((name) => `/${name}`)]);
  await opened.close();
});

test('a model that stands elsewhere looks like the model from elsewhere', async () => {
  const half = 0.5 * 50 * Math.PI / 180;
  const turned = { file: 'm', translation: [1000, -2000, 30], scale: 0.25,
                   rotation: [Math.cos(half), 0, 0, Math.sin(half)] };
  const elsewhere = await openScene([turned], { m: 'default' }, { ...kBare, azimuth: 350 });
  const here = await openPage(await singleFile(await sample('default')), { ...kBare, azimuth: 300 });
  assert.ok(Math.abs(elsewhere.state.distance / here.state.distance - 0.25) < 1e-6);
  assertSame(await pixelsOf(elsewhere.page), await pixelsOf(here.page), 'turned by 50 degrees');
  await elsewhere.close();
  await here.close();
});

test('two models show where each of them stands, and one stands in two places', async () => {
  const picture = (left, right, files) =>
    pictureOfScene([{ ...kLeft, file: left }, { ...kRight, file: right }], files);
  const both = await picture('a', 'b', { a: 'default', b: 'one_layout' });
  const ones = await picture('a', 'a', { a: 'default' });
  const others = await picture('b', 'b', { b: 'one_layout' });
  assertSame(leftHalf(both), leftHalf(ones), 'the left model');
  assertSame(rightHalf(both), rightHalf(others), 'the right model');
  assertDifferent(ones, others, 'the models');
  // Turned about the middle by half a turn, and seen from behind: each stands for the other.
  const places = [{ ...kLeft, file: 'a' },
                  { file: 'a', rotation: [0, 0, 0, 1],
                    translation: [2 * kCenter[0] + 150, 2 * kCenter[1], 0] }];
  assertSame(await pictureOfScene(places, { a: 'default' }, { ...kFromFront, azimuth: 90 }),
             await pictureOfScene(places, { a: 'default' }), 'half a turn');
});

test('the terms slider over models with different numbers of terms', async () => {
  for (const [first, second] of [['default', 'no_terms'], ['no_terms', 'default']]) {
    const { page, state, close } = await openScene(
      [{ ...kLeft, file: 'a' }, { ...kRight, file: 'b' }], { a: first, b: second },
      { ...kFromFront, panel: 1 });
    assert.deepEqual([state.loadedTerms, state.shownTerms, state.terms], [3, 3, 3]);
    assert.equal(await page.locator('#terms').getAttribute('max'), '3');
    assert.equal(await page.locator('#count').innerText(), '3 of 3');
    const all = await pixelsOf(page);
    await page.locator('#terms').fill('1');
    assert.deepEqual([(await stateOf(page)).terms, (await stateOf(page)).shownTerms], [1, 1]);
    await page.getByRole('button', { name: 'Mean view' }).click();
    assert.equal((await stateOf(page)).shownTerms, 0);
    const mean = await pixelsOf(page);
    const [same, other] = first === 'no_terms' ? [leftHalf, rightHalf] : [rightHalf, leftHalf];
    assertSame(same(mean), same(all), 'the model without terms');
    assertDifferent(other(mean), other(all), 'the model with terms');
    await close();
  }
});

test('a double click looks at any of the models, and the eye comes near to it', async () => {
  const small = { file: 'b', translation: [2000, 0, 0], scale: 0.5 };
  const { page, state, close } =
    await openScene([{ ...kLeft, file: 'a' }, small], { a: 'default', b: 'one_layout' });
  const pixelsPerMm = kHeight / (2 * state.distance * Math.tan(15 * Math.PI / 180));
  for (const [center, radius] of [
    [[kCenter[0] - 150, kCenter[1], kCenter[2]], kRadius],
    [[0.5 * kCenter[0] + 2000, 0.5 * kCenter[1], 0.5 * kCenter[2]], 0.5 * kRadius],
  ]) {
    await page.keyboard.press('Home');
    await page.waitForTimeout(200);
    await page.mouse.dblclick(kWidth / 2 + (center[0] - state.target[0]) * pixelsPerMm,
                              kHeight / 2 - (center[2] - state.target[2]) * pixelsPerMm);
    const { target } = await stateOf(page);
    const away = Math.hypot(...target.map((value, i) => value - center[i]));
    assert.ok(Math.abs(away - radius) < 0.1 * radius, `${away} mm from the middle of a sphere`);
  }
  await page.mouse.wheel(0, -12000);
  await page.waitForTimeout(200);
  const { distance, target } = await stateOf(page);
  assert.ok(distance < 1.1 * 0.5 * kRadius, `${distance} mm`);
  assert.ok(target[0] > 1900);
  const { count } = comparePictures(await pixelsOf(page), await pixelsOf(page), kBackground);
  assert.ok(count > kWidth * kHeight / 2, 'nothing is cut off near the eye');
  await close();
});

test('a model that fails is named, and the others are shown', async () => {
  const models = [{ ...kLeft, file: 'a.glb' }, { ...kRight, file: 'b.glb' }];
  const good = await sample('default');
  const alone = await pictureOfScene([models[0]], { 'a.glb': 'default' });
  const check = async (what, url, expected) => {
    const { page, complaints, state, close } = await openPage(url, kFromFront);
    const message = await messageOf(page);
    console.log(`${what}: ${message}`);
    assert.match(message, expected, what);
    assert.ok(message.startsWith('b.glb'), what);
    assert.deepEqual([state.loadedTerms, state.terms], [3, 3], what);
    assertSame(await pixelsOf(page), alone, what);
    await page.evaluate((hash) => { window.location.hash = hash; }, hashOf({ panel: 1 }));
    assert.ok(await page.locator('#terms').isVisible(), what);
    assert.ok(await page.locator('#progress').isHidden(), what);
    const box = await page.locator('#error').boundingBox();
    assert.ok(box.y + box.height < kHeight / 4, 'not in front of the picture');
    assert.deepEqual(complaints.filter((text) => !/404/.test(text)), [], what);
    await close();
  };
  const bad = Buffer.from('this is not a model, but long enough to be read');
  const cut = good.subarray(0, good.length / 2);
  for (const [what, bytes, expected] of [
    ['garbage', bad, /not a GLB file/], ['half a model', cut, /shorter or longer/],
    ['nothing', Buffer.alloc(0), /not there/],
  ]) {
    await check(what, await sceneFile(sceneOf(...models), { 'a.glb': good, 'b.glb': bytes }), expected);
  }
  await check('no element', await sceneFile(sceneOf(...models), { 'a.glb': good }), /not there/);
  await check('no file', await sceneFolder(sceneOf(...models), { 'a.glb': good }), /404/);
  await check('half a file', await sceneFolder(sceneOf(...models), { 'a.glb': good, 'b.glb': cut }),
              /cut off|shorter/);
});

test('a scene of which nothing can be shown gives one clear line', async () => {
  const bad = Buffer.from('this is not a model, but long enough to be read');
  const files = { 'a.glb': bad, 'b.glb': bad };
  const two = sceneOf({ file: 'a.glb' }, { file: 'b.glb' });
  for (const [what, urlOf, scene, expected] of [
    ['all broken', sceneFile, two, /^[ab]\.glb in this page: not a GLB file/],
    ['a damaged scene', sceneFile, two.slice(1), /^the scene in this page: damaged/],
    ['no scale', sceneFile, sceneOf({ file: 'a.glb', scale: 0 }), /scale/],
    ['served, damaged', sceneFolder, two.slice(1), /^scene\.json: damaged/],
    ['a file elsewhere', sceneFolder, sceneOf({ file: '//localhost/a.glb' }), /file/],
  ]) {
    const { page, complaints, close } = await openPage(await urlOf(scene, files));
    assert.match(await messageOf(page), expected, what);
    assert.deepEqual(complaints, [], what);
    await close();
  }
  const page = await readFile(path.join(web, 'index.html'), 'utf8');
  const url = await serve({
    '/': Buffer.from(page.replace('content="model.glb"', 'content="scene.json"')),
    '/app.js': path.join(web, 'app.js'),
  });
  const opened = await openPage(url);
  assert.match(await messageOf(opened.page), /^scene\.json: the server answers 404/);
  await opened.close();
});

test('measureFrames measures, and leaves the view as it was', async () => {
  const { page, complaints, close } = await openScene(
    [{ ...kLeft, file: 'a' }, { ...kRight, file: 'a' }], { a: 'default' });
  const before = await stateOf(page), picture = await pixelsOf(page);
  const milliseconds = await page.evaluate(() => window.lfm.measureFrames(4));
  assert.ok(Number.isFinite(milliseconds) && milliseconds > 0);
  const now = await stateOf(page);
  for (const key of ['azimuth', 'elevation', 'distance', 'target', 'loadedTerms', 'error']) {
    assert.deepEqual(now[key], before[key], key);
  }
  assertSame(await pixelsOf(page), picture, 'the picture');
  const refusal = (count) => page.evaluate(
    (frames) => window.lfm.measureFrames(frames).catch((error) => error.message), count);
  for (const count of [0, -1, 1.5, null, '3']) assert.equal(typeof await refusal(count), 'string');
  assert.deepEqual(complaints, []);
  await close();
});
