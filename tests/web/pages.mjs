// SPDX-License-Identifier: BSD-3-Clause
// The viewer's pages with models in them, for the tests in a browser.
//
// Environment: LFM_WEB (what viewer/web/build.mjs wrote), LFM_NODE_MODULES (playwright-core,
// three), LFM_CHROMIUM (its executable), LFM_SAMPLES (what web_samples wrote).
import assert from 'node:assert/strict';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { closeServers, launchChromium, newPage, serve, untilReady } from './browser.mjs';

export const web = path.resolve(process.env.LFM_WEB);
export const samples = path.resolve(process.env.LFM_SAMPLES);
export const nodeModules = process.env.LFM_NODE_MODULES;
export const kBackground = [0x18, 0x1a, 0x1f];
export const kLeastPsnr = 40; // dB over the foreground
export const kBare = { width: 640, height: 480, panel: 0, antialias: 0 };

let browser, scratch;

export async function startBrowser() {
  browser = await launchChromium(nodeModules, process.env.LFM_CHROMIUM ?? '/usr/bin/chromium');
  scratch = await mkdtemp(path.join(os.tmpdir(), 'lfm_web_'));
}

export async function stopBrowser() {
  closeServers();
  await browser?.close();
  await rm(scratch, { recursive: true, force: true });
}

/** See newPage of browser.mjs. */
export const blankPage = (options) => newPage(browser, options);

/** A page at `url` when all is drawn, or when it says what is wrong, with its `state`. */
export async function openPage(url, settings = {}, options = {}) {
  const opened = await blankPage(options);
  await opened.page.goto(url + hashOf(settings));
  return { ...opened, state: await untilReady(opened.page) };
}

export const sample = (name) => readFile(path.join(samples, `${name}.glb`));
export const hashOf = (settings) => `#${new URLSearchParams(settings)}`;
export const singleTemplate = () => readFile(path.join(web, 'single.html'), 'utf8');

/** The URL of a page on the disk. */
export async function onDisk(html, name) {
  const file = path.join(scratch, `${name}.html`);
  await writeFile(file, html);
  return pathToFileURL(file).href;
}

/** The URL of a single file with `bytes` in it. */
export async function singleFile(bytes, name = 'page') {
  const html = (await singleTemplate()).replace('@LFM_TITLE@', 'A &lt;sample&gt;')
    .replace('@LFM_MODEL_BASE64@', () => Buffer.from(bytes).toString('base64'));
  return onDisk(html, name);
}

/** The same of a scene: `scene` is the text of scene.json, `files` {name: bytes}. */
export async function sceneFile(scene, files, name = 'scene') {
  const mark = '<template id="model">@LFM_MODEL_BASE64@</template>';
  const elements = Object.entries(files).map(([file, bytes]) =>
    `<template data-file="${file}">${Buffer.from(bytes).toString('base64')}</template>`);
  const template = await singleTemplate();
  assert.ok(template.includes(mark));
  return onDisk(template.replace('@LFM_TITLE@', 'A scene')
    .replace(mark, () => [`<template id="scene">${scene}</template>`, ...elements].join('\n')), name);
}

/** The URL of the folder on a server; without a model where `glb` is null. */
export async function folder(glb, options) {
  return serve({
    '/': path.join(web, 'index.html'),
    '/index.html': path.join(web, 'index.html'),
    '/app.js': path.join(web, 'app.js'),
    ...(glb === null ? {} : { '/model.glb': glb }),
  }, options);
}

/** The same of a scene. */
export async function sceneFolder(scene, files, options) {
  const mark = '<meta name="model" content="model.glb">';
  const page = await readFile(path.join(web, 'index.html'), 'utf8');
  assert.ok(page.includes(mark));
  return serve({
    '/': Buffer.from(page.replace(mark, '<meta name="model" content="scene.json">')),
    '/app.js': path.join(web, 'app.js'),
    '/scene.json': Buffer.from(scene),
    ...Object.fromEntries(Object.entries(files).map(([name, bytes]) => [`/${name}`, bytes])),
  }, options);
}

/** What the page says is wrong, which must be one line. */
export async function messageOf(page) {
  const { error } = await untilReady(page);
  const text = await page.locator('#error').innerText();
  assert.ok(await page.locator('#error').isVisible());
  assert.equal(text, error);
  assert.ok(!text.includes('\n') && text.length < 200, text);
  return text;
}
