// SPDX-License-Identifier: BSD-3-Clause
// The pages for relighting in Chromium with software GL: hands, files, phones, and what is broken.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { pictureOf, stateOf } from './browser.mjs';
import { blankPage, messageOf, onDisk, startBrowser, stopBrowser } from './pages.mjs';
import {
  folder, near, openSample, sample, samples, singleFile, template,
} from './relight_pages.mjs';
import { withChecksums } from './tiny_relightable.mjs';

const kDirection_abs = 0.03; // pointers stop at whole pixels

before(startBrowser);
after(stopBrowser);

async function changes(page, what, act) {
  const before = await pictureOf(page);
  await act();
  await page.waitForTimeout(200);
  assert.ok(!before.equals(await pictureOf(page)), `${what} changes the picture`);
  return stateOf(page);
}

/** Presses the pointer at places of an element, in halves of its shorter side from its middle. */
async function drag(page, id, ...places) {
  const box = await page.locator(id).boundingBox(), half = Math.min(box.width, box.height) / 2;
  const [first, ...rest] = places.map(([x, y]) =>
    [box.x + box.width / 2 + half * x, box.y + box.height / 2 - half * y]);
  await page.mouse.move(...first);
  await page.mouse.down();
  for (const place of rest) await page.mouse.move(...place, { steps: 3 });
  await page.mouse.up();
}

test('one light: pointer, ball, keys, dials', async () => {
  const { page, complaints, close, state } = await openSample();
  let now = await changes(page, 'a click', () => drag(page, '#picture', [0.5, 0]));
  near(now.light, [Math.SQRT1_2, 0, Math.SQRT1_2], kDirection_abs);
  now = await changes(page, 'a drag', () => drag(page, '#picture', [0, 0], [-0.2, 0.1], [0, 2 / 3]));
  near(now.light, [0, Math.sin(Math.PI / 3), 0.5], kDirection_abs);
  assert.match(await page.locator('#reading').innerText(), /\d° (right|left), (59|60|61)° up/);
  now = await changes(page, 'the ball', () => drag(page, '#ball', [0, 0], [-0.6, 0]));
  near(now.light, [-0.6, 0, 0.8], 2 * kDirection_abs);
  const before = now.light;
  now = await changes(page, 'an arrow key', () => page.keyboard.press('ArrowRight'));
  const angle = Math.acos(before.reduce((sum, v, i) => sum + v * now.light[i], 0)) * 180 / Math.PI;
  near([angle], [5], 0.01);
  now = await changes(page, 'Home', () => page.keyboard.press('Home'));
  assert.deepEqual(now.light, state.light);
  now = await changes(page, 'the residuals dial', () => page.locator('#residuals').fill('1'));
  assert.equal(now.residuals, 1);
  assert.equal(await page.locator('output[for=residuals]').innerText(), '1 of 5');
  now = await changes(page, '[', () => page.keyboard.press('['));
  assert.equal(now.residuals, 0);
  now = await changes(page, 'the exposure dial', () => page.locator('#exposure').fill('1'));
  near([now.gain / state.gain], [2], 1e-6);
  assert.equal(await page.locator('output[for=exposure]').innerText(), '+1.0 EV');
  now = await changes(page, 'Reset', () => page.getByRole('button', { name: 'Reset' }).click());
  assert.deepEqual([now.residuals, now.gain], [5, state.gain]);
  assert.match(await page.locator('#reading').innerText(), /ms a frame/);
  assert.deepEqual(complaints, []);
  await close();
});

test('surroundings: chosen, turned by dial, drag and keys', async () => {
  const { page, complaints, close } = await openSample();
  assert.ok(!await page.locator('#turn').isVisible());
  let now = await changes(page, 'sun and sky', () => page.locator('#around').selectOption('sky'));
  assert.equal(now.around, 'sky');
  now = await changes(page, 'the dial', () => page.locator('#turn').fill('90'));
  assert.equal(now.turn, 90);
  const { width } = await page.locator('#picture').boundingBox();
  const { height } = await page.locator('#picture').boundingBox();
  now = await changes(page, 'a drag', () => drag(page, '#picture', [-0.5, 0], [0.5, 0]));
  near([now.turn], [90 + 90 * height / width], 2);
  await page.locator('#picture').focus();
  const { turn } = now;
  now = await changes(page, 'an arrow key', () => page.keyboard.press('ArrowRight'));
  near([now.turn], [turn + 5 > 180 ? turn - 355 : turn + 5], 1e-6);
  now = await changes(page, 'one light', () => page.locator('#around').selectOption(''));
  assert.equal(now.around, '');
  assert.deepEqual(complaints, []);
  await close();
});

/** A plain Radiance picture of one color but for a bright texel. */
function radiance(width, height, bright) {
  const pixels = Buffer.alloc(4 * width * height);
  for (let i = 0; i < width * height; ++i) {
    pixels.set(i === bright ? [250, 200, 30, 145] : [20, 30, 60, 127], 4 * i);
  }
  return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`),
                        pixels]);
}

test('own surroundings: by file and dropped; a broken one leaves the page as it was', async () => {
  const { page, complaints, requests, close } = await openSample();
  const choose = (name, buffer) =>
    page.locator('#file').setInputFiles({ name, mimeType: 'image/vnd.radiance', buffer });
  let now = await changes(page, 'a file', () => choose('one.hdr', radiance(64, 32, 700)));
  assert.equal(now.around, 'own');
  assert.equal(await page.locator('#around option:checked').innerText(), 'one.hdr');
  const drop = (name, bytes) => page.evaluate(([fileName, numbers]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([new Uint8Array(numbers)], fileName));
    window.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, cancelable: true }));
  }, [name, [...bytes]]);
  now = await changes(page, 'a dropped file', () => drop('two.hdr', radiance(64, 32, 1200)));
  assert.equal(await page.locator('#around option:checked').innerText(), 'two.hdr');
  const picture = await pictureOf(page);
  for (const [name, bytes, expected] of [['cut.hdr', radiance(64, 32, 1).subarray(0, 900), /cut short/],
                                         ['square.hdr', radiance(32, 32, 1), /twice as wide/],
                                         ['picture.png', Buffer.from('\x89PNG'), /not a Radiance/]]) {
    await drop(name, bytes);
    await page.waitForFunction((text) => document.getElementById('error').textContent.includes(text), name);
    const message = await page.locator('#error').innerText();
    assert.match(message, expected);
    assert.ok(message.startsWith(`${name}: `) && !message.includes('\n'));
    assert.ok(picture.equals(await pictureOf(page)));
  }
  await changes(page, 'a good one', () => choose('one.hdr', radiance(64, 32, 700)));
  assert.ok(!await page.locator('#error').isVisible());
  assert.equal((await stateOf(page)).error, null);
  assert.deepEqual(complaints, []);
  assert.deepEqual(await page.evaluate(() => window.violations), []);
  assert.equal(requests.length, 1);
  await close();
});

test('nothing is drawn while nothing changes; a change is drawn', async () => {
  const { page, close } = await openSample();
  await page.waitForTimeout(700);
  const before = (await stateOf(page)).draws;
  await page.waitForTimeout(500);
  assert.equal((await stateOf(page)).draws, before);
  await page.keyboard.press('ArrowUp');
  await page.waitForFunction((draws) => window.lfm.state().draws > draws, before);
  assert.ok(await page.evaluate(() => window.lfm.measureFrames(3)) > 0);
  await close();
});

test('a slow device draws a quarter of the pixels while something moves, then all', async () => {
  const { page, complaints, close } = await openSample('color', { slow: 1 });
  const full = await pictureOf(page);
  // Both sizes are seen, whatever the time between them.
  const sizes = await page.evaluate(() => new Promise((resolve) => {
    const seen = [], canvas = document.getElementById('picture');
    new MutationObserver(() => {
      seen.push([canvas.width, canvas.height]);
      if (canvas.width === 64 && canvas.height === 48) resolve(seen);
    }).observe(canvas, { attributeFilter: ['width', 'height'] });
    window.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft' }));
  }));
  assert.deepEqual(sizes[0], [32, 24]);
  assert.equal((await stateOf(page)).coarse, false);
  await page.keyboard.press('Home');
  assert.ok(full.equals(await pictureOf(page)));
  assert.deepEqual(complaints, []);
  await close();
});

test('touch on a phone: the light follows; all controls are in sight, none hides the picture', async () => {
  const phone = { viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true,
                  deviceScaleFactor: 2 };
  const { page, complaints, close } = await openSample('color', {}, phone);
  const picture = await page.locator('#picture').boundingBox();
  const client = await page.context().newCDPSession(page);
  const touch = (type, points) => client.send('Input.dispatchTouchEvent', {
    type, touchPoints: points.map(([x, y], id) => ({ x, y, id })),
  });
  const [x, y] = [picture.x + picture.width / 2, picture.y + picture.height / 2];
  const now = await changes(page, 'a finger', async () => {
    await touch('touchStart', [[x, y]]);
    await touch('touchMove', [[x - 10, y]]);
    await touch('touchMove', [[x - picture.height / 4, y]]);
    await touch('touchEnd', []);
  });
  near(now.light, [-Math.SQRT1_2, 0, Math.SQRT1_2], kDirection_abs);
  for (const around of ['', 'sky']) {
    await page.locator('#around').selectOption(around);
    for (const id of ['around', 'own', 'ball', 'residuals', 'exposure', 'home', 'title',
                      ...(around === '' ? [] : ['turn'])]) {
      const box = await page.locator(`#${id}`).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 360 && box.y + box.height <= 640, id);
      const stage = await page.locator('#stage').boundingBox();
      assert.ok(id === 'title' || box.y >= stage.y + stage.height, `${id} does not cover the picture`);
    }
    const shown = await page.locator('#picture').boundingBox();
    assert.ok(shown.width > 300 && Math.abs(shown.width / shown.height - 64 / 48) < 0.02);
  }
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
  assert.deepEqual(complaints, []);
  await close();
});

test('a broken model gives one clear line', async () => {
  const good = await sample('color');
  const edited = (at, value) => {
    const bytes = Buffer.from(good);
    bytes.writeUInt32LE(value, at);
    return bytes;
  };
  const bent = Buffer.from(good);
  bent[good.length / 2] ^= 1;
  const cases = {
    empty: [Buffer.alloc(0), /no model in this page/],
    garbage: [Buffer.from('this is not a model, but long enough to be read'), /not a model/],
    'cut in the header': [good.subarray(0, 100), /cut short/],
    'cut in the content': [good.subarray(0, good.length / 2), /should have/],
    'another version': [edited(8, 2), /version 2/],
    'a damaged header': [edited(20, 65), /header is damaged/],
    'damaged content': [bent, /content is damaged/],
    'huge counts': [withChecksums(edited(32, 0xffffffff)), /picture of/],
    vertices: [await readFile(path.join(samples, 'other', 'vertices.lfr')), /pictures only/],
    views: [await readFile(path.join(samples, 'other', 'views.lfr')), /nothing to relight/],
  };
  for (const [what, [bytes, expected]] of Object.entries(cases)) {
    const { page, complaints, close } = await blankPage();
    await page.goto(await singleFile(bytes, { name: 'broken' }));
    const message = await messageOf(page);
    assert.match(message, expected, what);
    console.log(`${what}: ${message}`);
    assert.deepEqual(complaints, [], what);
    await close();
  }
  const { page, close } = await blankPage();
  await page.goto(await onDisk((await template()).replace('@LFM_MODEL_BASE64@', 'no!base64'), 'text'));
  assert.match(await messageOf(page), /damaged/);
  await close();
});

test('a server without the model, or that breaks off, gives one clear line', async () => {
  const good = await sample('color');
  for (const [lfr, expected] of [[null, /404/], [good.subarray(0, 9000), /should have/]]) {
    const { page, close } = await blankPage();
    await page.goto(await folder(lfr));
    assert.match(await messageOf(page), expected);
    await close();
  }
  const { page, close } = await blankPage();
  await page.goto(pathToFileURL(path.join(samples, 'pages', 'index.html')).href);
  await page.waitForFunction(() => window.lfm !== undefined);
  assert.match(await messageOf(page), /serve this folder/);
  await close();
});

test('a device without WebGL 2 gets one clear line', async () => {
  const { page, complaints, close } = await blankPage();
  await page.addInitScript(() => { HTMLCanvasElement.prototype.getContext = () => null; });
  await page.goto(await singleFile(await sample('color')));
  assert.match(await page.locator('#error').innerText(), /does not offer WebGL 2/);
  assert.deepEqual(complaints, []);
  await close();
});
