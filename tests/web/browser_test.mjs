// SPDX-License-Identifier: BSD-3-Clause
// The browser viewer in Chromium with software GL.
//
// Of the samples (pages.mjs), NAME.png and NAME,azimuth=30,terms=2.png are what lfm-render shows of
// NAME.glb with --supersample 1, at the settings that the name tells, else --size 640x480; the
// viewer's own test settings otherwise.
import assert from 'node:assert/strict';
import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { pictureOf, serve, stateOf, untilReady } from './browser.mjs';
import {
  blankPage, folder, hashOf, kBackground, kBare, kLeastPsnr, messageOf, nodeModules, onDisk,
  openPage, sample, samples, singleFile, singleTemplate, startBrowser, stopBrowser, web,
} from './pages.mjs';
import { comparePictures, decodePng } from './png.mjs';

const names = await readdir(samples);
const models = names.filter((name) => name.endsWith('.glb')).map((name) => name.slice(0, -4));
const model = models.find((name) => name.includes('default')) ?? models[0];

before(startBrowser);
after(stopBrowser);

async function openSample(name = model, settings = {}, options = {}) {
  const opened = await openPage(await singleFile(await sample(name), name), settings, options);
  assert.equal(opened.state.error, null);
  return opened;
}

test('one placeholder each, and no way to the network', async () => {
  const text = await singleTemplate();
  assert.equal(text.split('@LFM_MODEL_BASE64@').length, 2);
  assert.equal(text.split('@LFM_TITLE@').length, 2);
  const policy = text.match(/Content-Security-Policy" content="([^"]*)"/)[1];
  assert.match(policy, /^default-src 'none'; script-src 'sha256-[^']+'; style-src 'sha256-[^']+';/);
  assert.doesNotMatch(policy, /unsafe|connect-src|http|blob|data:/);
});

for (const name of models) {
  test(`${name}: a single file from the disk shows what lfm-render shows`, async () => {
    const opened = await openSample(name, kBare);
    const { page, complaints, requests, state } = opened;
    assert.ok(state.loadedTerms >= 0 && state.loadedTerms === state.terms);
    const { pageRead, meanShown, allShown } = state.times;
    console.log(`${name}: ms since navigation: page read ${pageRead.toFixed()}, ` +
                `mean view ${meanShown.toFixed()}, all terms ${allShown.toFixed()}`);
    const references = names.filter((file) => file.endsWith('.png') &&
                                              file.slice(0, -4).split(',')[0] === name);
    assert.ok(references.length > 0, `no picture of ${name}`);
    for (const file of references) {
      const [, ...parts] = file.slice(0, -4).split(',');
      const own = Object.fromEntries(parts.map((part) => part.split('=')));
      await page.evaluate((hash) => { window.location.hash = hash; },
                          hashOf({ ...kBare, terms: 16, ...own }));
      await page.waitForTimeout(50); // hashchange comes later
      const reference = decodePng(await readFile(path.join(samples, file)));
      const found = comparePictures(decodePng(await pictureOf(page)), reference, kBackground);
      console.log(`${file}: ${found.psnr.toFixed(2)} dB, largest difference ${found.largest}`);
      assert.ok(found.psnr >= kLeastPsnr, `${file}: ${found.psnr} dB`);
      assert.ok(found.outside < found.count / 500, `${file}: ${found.outside} pixels outside`);
    }
    assert.deepEqual(complaints, []);
    assert.deepEqual(await page.evaluate(() => window.violations), []);
    assert.deepEqual(requests.filter((url) => !url.startsWith('file:')), []);
    assert.equal(requests.length, 1);
    await opened.close();
  });
}

for (const name of models.filter((name) => name.includes('bc'))) {
  test(`${name}: the same where the device reads no blocks`, async () => {
    const opened = await openSample(name, { ...kBare, blocks: 'decode' });
    const reference = decodePng(await readFile(path.join(samples, `${name}.png`)));
    const picture = decodePng(await pictureOf(opened.page));
    const { psnr } = comparePictures(picture, reference, kBackground);
    console.log(`${name}, decoded: ${psnr.toFixed(2)} dB`);
    assert.ok(psnr >= kLeastPsnr);
    await opened.close();
  });
}

test('what is on the screen is the picture', async () => {
  const { page, close } = await openSample(model, kBare);
  const screen = decodePng(await page.screenshot());
  const reference = decodePng(await readFile(path.join(samples, `${model}.png`)));
  assert.ok(comparePictures(screen, reference, kBackground).psnr >= kLeastPsnr);
  await close();
});

test('the folder on a server: the mean view first, then all', async () => {
  const url = await folder(await sample(model), { slowly: 100000 });
  const { page, complaints, requests, close } = await blankPage();
  await page.goto(url + hashOf(kBare));
  const { error, loadedTerms, terms, times } = await untilReady(page);
  assert.equal(error, null);
  assert.equal(loadedTerms, terms);
  console.log(`slow server: mean view ${times.meanShown.toFixed()}, tables ` +
              `${times.tablesRead.toFixed()}, all terms ${times.allShown.toFixed()} ms`);
  assert.ok(times.meanShown < times.allShown);
  const reference = decodePng(await readFile(path.join(samples, `${model}.png`)));
  const { psnr } = comparePictures(decodePng(await pictureOf(page)), reference, kBackground);
  assert.ok(psnr >= kLeastPsnr, `${psnr} dB`);
  assert.deepEqual(complaints, []);
  assert.deepEqual(await page.evaluate(() => window.violations), []);
  assert.deepEqual(requests.map((url) => new URL(url).pathname).sort(),
                   ['/', '/app.js', '/model.glb']);
  await close();
});

test('mouse, keyboard and controls', async () => {
  const { page, complaints, close, state } = await openSample();
  const changes = async (what, act) => {
    const before = await stateOf(page), picture = await pictureOf(page);
    await act();
    await page.waitForTimeout(200);
    assert.ok(!picture.equals(await pictureOf(page)), `${what} changes the picture`);
    return { before, now: await stateOf(page) };
  };
  let { before, now } = await changes('a drag', async () => {
    await page.mouse.move(300, 200);
    await page.mouse.down();
    await page.mouse.move(360, 230, { steps: 3 });
    await page.mouse.up();
  });
  const height = await pictureHeight(page);
  assert.ok(Math.abs(before.azimuth - now.azimuth - 60 * 180 / height) < 0.01, 'as in lfm-viewer');
  assert.ok(Math.abs(now.elevation - before.elevation - 30 * 180 / height) < 0.01);
  ({ before, now } = await changes('the wheel', () => page.mouse.wheel(0, -200)));
  assert.ok(Math.abs(now.distance / before.distance - 0.81) < 0.001);
  ({ before, now } = await changes('the right button', async () => {
    await page.mouse.down({ button: 'right' });
    await page.mouse.move(380, 230);
    await page.mouse.up({ button: 'right' });
  }));
  assert.notDeepEqual(now.target, before.target);
  ({ before, now } = await changes('an arrow key', () => page.keyboard.press('ArrowLeft')));
  assert.ok(Math.abs(before.azimuth - now.azimuth - 5) < 0.01);
  ({ before, now } = await changes('plus', () => page.keyboard.press('+')));
  assert.ok(now.distance < before.distance);
  ({ now } = await changes('Home', () => page.keyboard.press('Home')));
  assert.deepEqual([now.azimuth, now.distance], [state.azimuth, state.distance]);
  ({ before, now } = await changes('a double click', () => page.mouse.dblclick(320, 240)));
  assert.notDeepEqual(now.target, before.target);
  await page.keyboard.press('Home');
  ({ now } = await changes('the terms slider', () => page.locator('#terms').fill('1')));
  assert.equal(now.shownTerms, 1);
  ({ now } = await changes('the mean view',
                          () => page.getByRole('button', { name: 'Mean view' }).click()));
  assert.equal(now.shownTerms, 0);
  assert.equal(await page.locator('#mean').getAttribute('aria-pressed'), 'true');
  ({ now } = await changes('m', () => page.keyboard.press('m')));
  assert.equal(now.shownTerms, 1);
  ({ now } = await changes(']', () => page.keyboard.press(']')));
  assert.equal(now.shownTerms, 2);
  assert.deepEqual(complaints, []);
  await close();
});

const pictureHeight = (page) => page.locator('#picture').evaluate((canvas) => canvas.clientHeight);

test('nothing is drawn while nothing changes', async () => {
  const { page, close } = await openSample();
  await page.waitForTimeout(300);
  const before = (await stateOf(page)).draws;
  await page.waitForTimeout(500);
  assert.equal((await stateOf(page)).draws, before);
  await close();
});

test('touch on a phone: one finger turns, two zoom; all controls are in sight', async () => {
  const phone = { viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true,
                  deviceScaleFactor: 2 };
  const { page, complaints, close, state } = await openSample(model, {}, phone);
  const client = await page.context().newCDPSession(page);
  const touch = (type, points) => client.send('Input.dispatchTouchEvent', {
    type, touchPoints: points.map(([x, y], id) => ({ x, y, id })),
  });
  await touch('touchStart', [[150, 250]]);
  await touch('touchMove', [[200, 250]]);
  await touch('touchEnd', []);
  const turned = await stateOf(page);
  const height = await pictureHeight(page);
  assert.ok(Math.abs(state.azimuth - turned.azimuth - 50 * 180 / height) < 0.5, 'one finger turns');
  await touch('touchStart', [[150, 250], [210, 250]]);
  await touch('touchMove', [[120, 250], [240, 250]]);
  await touch('touchEnd', []);
  const zoomed = await stateOf(page);
  assert.ok(zoomed.distance < 0.6 * turned.distance, 'two fingers zoom');
  for (const id of ['terms', 'mean', 'home', 'title']) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 360 && box.y + box.height <= 640, id);
    assert.ok(id === 'title' || box.y >= height, 'controls do not cover the object');
  }
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
  assert.deepEqual(complaints, []);
  await close();
});

test('in a frame of a page, the wheel goes on scrolling it', async () => {
  const inner = await singleFile(await sample(model), 'inner');
  const outer = await onDisk(`<button autofocus>outside</button><iframe src="${inner}" width="500"
    height="300" allow="fullscreen"></iframe><p style="height: 2000px">`, 'outer');
  const { page, complaints, close } = await blankPage();
  await page.goto(outer);
  const frame = page.frames()[1];
  await frame.waitForFunction(() => window.lfm !== undefined);
  const { error, distance } = await frame.evaluate(() => window.lfm.ready);
  assert.equal(error, null);
  const wheel = async () => {
    await page.mouse.move(250, 150);
    await page.mouse.wheel(0, 100);
    await page.waitForTimeout(300);
    return frame.evaluate(() => window.lfm.state().distance);
  };
  assert.equal(await wheel(), distance);
  assert.ok(await page.evaluate(() => window.scrollY) > 0);
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.mouse.click(250, 150);
  assert.ok(await wheel() > distance);
  assert.deepEqual(complaints, []);
  await close();
});

test('a broken model gives one clear line', async () => {
  const good = await sample(model);
  const cases = {
    empty: [Buffer.alloc(0), /no model in this page/],
    garbage: [Buffer.from('this is not a model, but long enough to be read'), /not a GLB file/],
    'cut in the header': [good.subarray(0, 10), /cut off/],
    'cut in the JSON': [good.subarray(0, 3000), /shorter or longer|cut off/],
    'cut in the pages': [good.subarray(0, good.length / 2), /shorter or longer/],
    'damaged pictures': [damagedPictures(good), /damaged|not an 8-bit RGB PNG/],
  };
  for (const [what, [bytes, expected]] of Object.entries(cases)) {
    const { page, complaints, close } = await blankPage();
    await page.goto(await singleFile(bytes, 'broken'));
    const message = await messageOf(page);
    assert.match(message, expected, what);
    console.log(`${what}: ${message}`);
    assert.deepEqual(complaints, [], what);
    await close();
  }
  const { page, complaints, close } = await blankPage();
  await page.goto(await onDisk(
    (await singleTemplate()).replace('@LFM_MODEL_BASE64@', 'no!base64'), 'text'));
  assert.match(await messageOf(page), /damaged/);
  assert.deepEqual(complaints, []);
  await close();
});

// All pictures of the file overwritten with zeros.
function damagedPictures(good) {
  const bytes = Buffer.from(good);
  const jsonBytes = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + jsonBytes));
  for (const { bufferView } of json.images) {
    const { byteOffset = 0, byteLength } = json.bufferViews[bufferView];
    bytes.fill(0, 28 + jsonBytes + byteOffset + 40, 28 + jsonBytes + byteOffset + byteLength);
  }
  return bytes;
}

test('a server without the model, or that breaks off, gives one clear line', async () => {
  const good = await sample(model);
  for (const [glb, expected] of [[null, /404/], [good.subarray(0, 100000), /cut off|shorter/]]) {
    const url = await folder(glb);
    const { page, close } = await blankPage();
    await page.goto(url);
    assert.match(await messageOf(page), expected);
    await close();
  }
  const { page, close } = await blankPage();
  await page.goto(pathToFileURL(path.join(web, 'index.html')).href);
  await page.waitForFunction(() => window.lfm !== undefined);
  assert.match(await messageOf(page), /serve this folder/);
  await close();
});

test('a device without WebGL 2 gets one clear line', async () => {
  const { page, complaints, close } = await blankPage();
  await page.addInitScript(() => { HTMLCanvasElement.prototype.getContext = () => null; });
  await page.goto(await singleFile(await sample(model)));
  assert.match(await page.locator('#error').innerText(), /does not offer WebGL 2/);
  assert.deepEqual(complaints, []);
  await close();
});

test('the plugin works in a scene of its own', async () => {
  const three = path.join(path.resolve(nodeModules), 'three');
  const url = await serve({
    '/': Buffer.from(`<!DOCTYPE html><script type="importmap">{"imports":{
      "three":"/three.module.js", "three/addons/":"/"}}</script><canvas></canvas>
      <script type="module">
      import * as THREE from 'three';
      import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
      import { LightFieldPlugin } from '/plugin.js';
      const renderer = new THREE.WebGLRenderer({ canvas: document.querySelector('canvas') });
      renderer.setSize(640, 480);
      const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(30, 4 / 3, 0.01, 10);
      scene.background = new THREE.Color('#181a1f');
      const azimuth = 300 * Math.PI / 180, elevation = 25 * Math.PI / 180;
      const loader = new GLTFLoader();
      loader.register((parser) => new LightFieldPlugin(parser));
      const gltf = await loader.loadAsync('/model.glb');
      scene.add(gltf.scene);
      renderer.setAnimationLoop(() => renderer.render(scene, camera));
      window.show = async (x, y, z, distance) => {
        // mm, z up, as the node turns and scales it to m, y up
        const target = new THREE.Vector3(x, z, -y).multiplyScalar(0.001);
        const flat = Math.cos(elevation);
        camera.position.set(flat * Math.cos(azimuth), Math.sin(elevation), -flat * Math.sin(azimuth))
          .multiplyScalar(0.001 * distance).add(target);
        camera.lookAt(target);
        const object = await gltf.userData.lightField.ready;
        renderer.render(scene, camera);
        return [object.loadedTerms, renderer.domElement.toDataURL()];
      };
      </script>`),
    '/model.glb': await sample(model),
    '/plugin.js': path.join(web, 'lfm-surface-light-field.js'),
    '/three.module.js': path.join(three, 'build/three.module.js'),
    '/three.core.js': path.join(three, 'build/three.core.js'),
    '/loaders/GLTFLoader.js': path.join(three, 'examples/jsm/loaders/GLTFLoader.js'),
    '/utils/BufferGeometryUtils.js': path.join(three, 'examples/jsm/utils/BufferGeometryUtils.js'),
    '/utils/SkeletonUtils.js': path.join(three, 'examples/jsm/utils/SkeletonUtils.js'),
  });
  const viewer = await openSample(model, kBare);
  const { target, distance } = viewer.state;
  await viewer.close();
  const { page, complaints, close } = await blankPage();
  await page.goto(url);
  await page.waitForFunction(() => window.show !== undefined);
  const [loadedTerms, data] =
    await page.evaluate((args) => window.show(...args), [...target, distance]);
  assert.equal(loadedTerms, viewer.state.terms);
  const reference = decodePng(await readFile(path.join(samples, `${model}.png`)));
  const picture = decodePng(Buffer.from(data.split(',')[1], 'base64'));
  const { psnr } = comparePictures(picture, reference, kBackground);
  console.log(`plugin: ${psnr.toFixed(2)} dB`);
  assert.ok(psnr >= 35, `${psnr} dB`); // smoothed edges here
  assert.deepEqual(complaints.filter((text) => !text.includes('404')), []); // favicon.ico
  await close();
});
