// SPDX-License-Identifier: BSD-3-Clause
// What the pages for relighting show in Chromium with software GL, against what the C++ relighting
// and its sampling of light show (relight_pages.mjs).
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { evaluateRow, prepareLight } from '../../viewer/web/relight/evaluation.js';
import { parseRelightable } from '../../viewer/web/relight/lfr_file.js';
import { makeSurroundings } from '../../viewer/web/relight/made_surroundings.js';
import { ModelLight } from '../../viewer/web/relight/model_light.js';
import { uprightFrameOf, viewFrameOf } from '../../viewer/web/relight/view_frame.js';
import { pictureOf, serve, stateOf } from './browser.mjs';
import { kLeastPsnr, openPage, startBrowser, stopBrowser } from './pages.mjs';
import { comparePictures, decodePng } from './png.mjs';
import {
  kNoBackground, models, near, openSample, sample, samples, shotsOf, template,
} from './relight_pages.mjs';

before(startBrowser);
after(stopBrowser);

const psnrOf = (picture, reference) =>
  comparePictures(picture, reference, kNoBackground).psnr;

test('one placeholder each, and no way to the network', async () => {
  const text = await template();
  for (const mark of ['@LFM_MODEL_BASE64@', '@LFM_TITLE@', '@LFM_CAMERA@']) {
    assert.equal(text.split(mark).length, 2, mark);
  }
  const policy = text.match(/Content-Security-Policy" content="([^"]*)"/)[1];
  assert.match(policy, /^default-src 'none'; script-src 'sha256-[^']+'; style-src 'sha256-[^']+';/);
  assert.doesNotMatch(policy, /unsafe|connect-src|http|blob|data:/);
});

for (const name of models) {
  test(`${name}: a single file from the disk shows what the C++ relighting shows`, async () => {
    const { page, complaints, requests, close } = await openSample(name);
    const shots = await shotsOf(name);
    assert.equal(shots.length, 3);
    for (const { shot, gain, residuals, light, png } of shots) {
      await page.evaluate(([settings, numbers]) => {
        window.lfm.set(settings);
        window.lfm.light(numbers);
      }, [{ gain, residuals }, light]);
      const picture = decodePng(await pictureOf(page)), reference = decodePng(png);
      const { psnr, largest } = comparePictures(picture, reference, kNoBackground);
      console.log(`${shot}: ${psnr.toFixed(2)} dB, largest difference ${largest}`);
      assert.ok(psnr >= kLeastPsnr, `${shot}: ${psnr} dB`);
    }
    assert.deepEqual(complaints, []);
    assert.deepEqual(await page.evaluate(() => window.violations), []);
    assert.equal(requests.length, 1);
    await close();
  });
}

test('the references differ, so that a wrong one would be seen', async () => {
  const [all, few, none] = (await shotsOf('color')).map(({ png }) => decodePng(png));
  for (const [a, b] of [[all, few], [few, none], [all, none]]) assert.ok(psnrOf(a, b) < 25);
});

test('what is on the screen is the picture', async () => {
  const { page, close } = await openSample('color', { panel: 0 }, { viewport: { width: 64, height: 48 } });
  const screen = decodePng(await page.screenshot());
  assert.ok(psnrOf(screen, decodePng(await pictureOf(page))) >= kLeastPsnr);
  await close();
});

test('the pages that the program writes, from disk and from a server, know their camera', async () => {
  const pages = path.join(samples, 'pages');
  const url = await serve(Object.fromEntries([['/', 'index.html'], ['/app.js', 'app.js'],
    ['/model.lfr', 'model.lfr']].map(([at, file]) => [at, path.join(pages, file)])));
  const pictures = [];
  for (const place of [pathToFileURL(path.join(pages, 'relight.html')).href, url]) {
    const { page, complaints, requests, state, close } = await openPage(place, { light: '0,0,1' });
    assert.equal(state.error, null);
    assert.equal(await page.title(), 'A <sample>');
    assert.match(await page.locator('#reading').innerText(), /0° right, 90° up/); // z is up
    await page.keyboard.press('ArrowDown');
    near((await stateOf(page)).light, [0, -Math.sin(Math.PI / 36), Math.cos(Math.PI / 36)], 1e-9);
    pictures.push(await pictureOf(page));
    assert.deepEqual(complaints, []);
    assert.deepEqual(await page.evaluate(() => window.violations), []);
    assert.equal(requests.length, place === url ? 3 : 1);
    await close();
  }
  assert.ok(pictures[0].equals(pictures[1]));
});

test('one light and surroundings of a file are those of the C++ sampling', async () => {
  const pages = path.join(samples, 'pages');
  const gains = JSON.parse(await readFile(path.join(pages, 'gains.json'), 'utf8'));
  const { page, close } = await openPage(pathToFileURL(path.join(pages, 'relight.html')).href,
                                         { light: '0.3,-0.4,1', gain: gains.light, turn: 40 });
  const psnr = async (what) =>
    psnrOf(decodePng(await pictureOf(page)), decodePng(await readFile(path.join(pages, `${what}.png`))));
  const light = await psnr('light');
  await page.locator('#file').setInputFiles(path.join(pages, 'surroundings.hdr'));
  await page.waitForFunction(() => window.lfm.state().around === 'own');
  await page.evaluate((gain) => window.lfm.set({ gain }), gains.surroundings);
  const around = await psnr('surroundings');
  console.log(`one light: ${light.toFixed(2)} dB, surroundings: ${around.toFixed(2)} dB`);
  assert.ok(light >= kLeastPsnr && around >= kLeastPsnr);
  await page.evaluate(() => window.lfm.set({ turn: 0 }));
  assert.ok(await psnr('surroundings') < kLeastPsnr - 10, 'another turn is seen');
  await close();
});

/** What float64 says that a model shows, {width, height, rgb}. */
function evaluate(model, light, gain) {
  const prepared = prepareLight(model, light), { points, channels, width, height } = model;
  const rgb = new Uint8Array(3 * points);
  for (let i = 0; i < 3 * points; ++i) {
    const c = channels === 1 ? 0 : i % 3;
    const linear = gain * evaluateRow(model, c * points + Math.floor(i / 3), prepared[c]);
    const v = Math.min(1, Math.max(0, linear));
    rgb[i] = Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
  }
  return { width, height, rgb };
}

for (const name of ['color', 'gray', 'pairs', 'cube']) {
  test(`${name}: one light and surroundings reach the picture`, async () => {
    const model = parseRelightable(new Uint8Array(await sample(name)), name);
    const lights = new ModelLight(model, uprightFrameOf(viewFrameOf('')));
    const { page, complaints, close } = await openSample(name, { light: '0.3,-0.5,0.8' });
    const check = async (what, light) => {
      const { gain } = await stateOf(page), picture = decodePng(await pictureOf(page));
      const psnr = psnrOf(picture, evaluate(model, light, gain));
      console.log(`${what}: ${psnr.toFixed(2)} dB`);
      assert.ok(psnr >= kLeastPsnr, `${what}: ${psnr} dB`);
    };
    await check('one light', lights.parallel((await stateOf(page)).light));
    for (const [around, turn] of [['sky', 0], ['studio', 75], ['window', -140]]) {
      await page.evaluate((settings) => window.lfm.set(settings), { around, turn });
      await check(around, lights.surroundings(makeSurroundings(around), turn));
    }
    assert.deepEqual(complaints, []);
    await close();
  });
}
