// SPDX-License-Identifier: BSD-3-Clause
// Times pages of lfm-render --web in Chromium with software GL, 1024x768:
//
//   node bench/web_bench.mjs NODE_MODULES CHROMIUM PAGE.html...
//
// Milliseconds from navigation until the browser has read the file, until the mean view is on
// screen, and until all terms are; medians of seven runs, each in a fresh context. Then frames a
// second of the whole model, each frame turned by a degree (window.lfm.measureFrames), one term
// and all of them.
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { launchChromium, newPage, untilReady } from '../tests/web/browser.mjs';

const kRuns = 7, kFrames = 15;

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

const [nodeModules, chromium, ...pages] = process.argv.slice(2);
if (pages.length === 0) {
  console.error('node bench/web_bench.mjs NODE_MODULES CHROMIUM PAGE.html...');
  process.exit(2);
}
const browser = await launchChromium(nodeModules, chromium);
try {
  console.log('| page | read | mean view | all terms | 1 term | all terms |');
  console.log('|---|---|---|---|---|---|');
  for (const file of pages) {
    const times = { pageRead: [], meanShown: [], allShown: [] };
    let frames = [];
    for (let run = 0; run < kRuns; ++run) {
      const { page, close } = await newPage(browser, { viewport: { width: 1024, height: 768 } });
      await page.goto(pathToFileURL(path.resolve(file)).href, { waitUntil: 'commit' });
      const state = await untilReady(page);
      if (state.error) throw new Error(`${file}: ${state.error}`);
      for (const key of Object.keys(times)) times[key].push(state.times[key]);
      if (run === kRuns - 1) {
        for (const terms of [1, 1024]) {
          await page.evaluate((n) => window.lfm.set({ ...{ terms: n }, azimuth: 300, elevation: 25,
            distance: 0, fov: 30, background: '181a1f', panel: '0' }), terms);
          frames.push(await page.evaluate((n) => window.lfm.measureFrames(n), kFrames));
        }
      }
      await close();
    }
    const cells = Object.values(times).map((list) => `${(median(list) / 1000).toFixed(2)} s`);
    frames = frames.map((time) => `${(1000 / time).toFixed(1)} frames/s`);
    console.log(`| ${path.basename(file)} | ${[...cells, ...frames].join(' | ')} |`);
  }
} finally {
  await browser.close();
}
