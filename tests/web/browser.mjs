// SPDX-License-Identifier: BSD-3-Clause
// Pages in Chromium, for pages.mjs.
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { readFile } from 'node:fs/promises';
import path from 'node:path';

const kTypes = { '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json',
                 '.glb': 'model/gltf-binary' };
const servers = [];

const kReadyMilliseconds = 120000; // a hang, not a speed

export async function launchChromium(nodeModules, executablePath) {
  const require = createRequire(path.join(path.resolve(nodeModules), 'x.js'));
  const { chromium } = require('playwright-core');
  return chromium.launch({
    executablePath,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
           '--enable-unsafe-swiftshader'],
  });
}

/** A page that notes what it must not do: {page, complaints, requests}. */
export async function newPage(browser, options = {}) {
  const context = await browser.newContext({ viewport: { width: 640, height: 480 }, ...options });
  const page = await context.newPage();
  const complaints = [], requests = [];
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => requests.push(request.url()));
  await page.addInitScript(() => {
    window.violations = [];
    document.addEventListener('securitypolicyviolation', (event) => {
      window.violations.push(`${event.violatedDirective} ${event.blockedURI}`);
    });
  });
  return { page, complaints, requests, close: () => context.close() };
}

/** The state of the page when all is drawn, or when it says what is wrong. */
export async function untilReady(page) {
  return page.evaluate((most) => Promise.race([
    window.lfm.ready,
    new Promise((_, reject) => setTimeout(() => reject(new Error('not ready')), most)),
  ]), kReadyMilliseconds);
}

export const stateOf = (page) => page.evaluate(() => window.lfm.state());

/** PNG of what the page's canvas shows. */
export async function pictureOf(page) {
  const url = await page.evaluate(() => window.lfm.picture());
  return Buffer.from(url.split(',')[1], 'base64');
}

/**
 * Serves `files`, {path: Buffer or file name}; resolves with the URL. `slowly`: bytes a step of 20 ms of .glb files.
 */
export async function serve(files, { slowly = 0 } = {}) {
  const server = createServer(async (request, response) => {
    const content = files[new URL(request.url, 'http://localhost').pathname];
    if (content === undefined) {
      response.writeHead(404).end();
      return;
    }
    const bytes = typeof content === 'string' ? await readFile(content) : content;
    const ending = request.url === '/' ? '.html' : path.extname(request.url.split('?')[0]);
    response.writeHead(200, {
      'content-type': kTypes[ending] ?? 'application/octet-stream',
      'content-length': bytes.length,
    });
    if (slowly === 0 || ending !== '.glb') {
      response.end(bytes);
      return;
    }
    for (let at = 0; at < bytes.length && !response.destroyed; at += slowly) {
      response.write(bytes.subarray(at, at + slowly));
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
    response.end();
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  servers.push(server);
  return `http://127.0.0.1:${server.address().port}/`;
}

export function closeServers() {
  for (const server of servers.splice(0)) {
    server.closeAllConnections();
    server.close();
  }
}
