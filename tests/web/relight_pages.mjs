// SPDX-License-Identifier: BSD-3-Clause
// The pages for relighting with models in them, for the tests in a browser.
//
// Environment: that of pages.mjs, and LFM_RELIGHT_SAMPLES (what relight_samples wrote).
import assert from 'node:assert/strict';
import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import { serve } from './browser.mjs';
import { onDisk, openPage, web } from './pages.mjs';

export const samples = path.resolve(process.env.LFM_RELIGHT_SAMPLES);
export const kNoBackground = [-1, -1, -1]; // every pixel counts

const names = await readdir(samples);
export const models =
  names.filter((name) => name.endsWith('.lfr')).map((name) => name.slice(0, -4));

export const sample = (name) => readFile(path.join(samples, `${name}.lfr`));
export const template = () => readFile(path.join(web, 'relight_single.html'), 'utf8');

/** What the C++ relighting shows of a model: [{shot, gain, residuals, light, png}]. */
export async function shotsOf(name) {
  const shots = names.filter((file) => file.startsWith(`${name},`) && file.endsWith('.json'));
  return Promise.all(shots.map(async (file) => ({
    shot: file.slice(0, -5),
    ...JSON.parse(await readFile(path.join(samples, file), 'utf8')),
    png: await readFile(path.join(samples, `${file.slice(0, -5)}.png`)),
  })));
}

/** The URL of a single file with `bytes` in it. */
export async function singleFile(bytes, { name = 'relight', camera = '' } = {}) {
  const html = (await template()).replace('@LFM_TITLE@', 'A &lt;sample&gt;')
    .replace('@LFM_CAMERA@', camera)
    .replace('@LFM_MODEL_BASE64@', () => Buffer.from(bytes).toString('base64'));
  return onDisk(html, name);
}

/** The URL of the folder on a server; without a model where `lfr` is null. */
export const folder = (lfr) => serve({
  '/': path.join(web, 'relight_index.html'),
  '/app.js': path.join(web, 'relight_app.js'),
  ...(lfr === null ? {} : { '/model.lfr': lfr }),
});

/** A page with a sample in it, when all is drawn. */
export async function openSample(name = 'color', settings = {}, options = {}) {
  const opened = await openPage(await singleFile(await sample(name), { name }), settings, options);
  assert.equal(opened.state.error, null);
  return opened;
}

export const near = (found, expected, tolerance) => found.forEach((value, i) =>
  assert.ok(Math.abs(value - expected[i]) <= tolerance, `${found} instead of ${expected}`));
