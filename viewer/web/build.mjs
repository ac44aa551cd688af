// SPDX-License-Identifier: BSD-3-Clause
// node build.mjs OUT NODE_MODULES: writes into the folder OUT
//
//   index.html, app.js           with a model.glb beside them, for any static server; the title too.
//                                For a scene, <meta name="model"> is to name its scene.json
//   single.html                  one file; @LFM_TITLE@ is to be replaced by escaped text, and
//                                @LFM_MODEL_BASE64@ by the base64 of a model. For a scene, the
//                                template with it is to be replaced by those that
//                                src/model_bytes.js finds
//   lfm-surface-light-field.js   the plugin for GLTFLoader, three.js not included
//   relight_index.html, relight_app.js, relight_single.html   the same three for a model.lfr, which
//                                is to be relit; @LFM_CAMERA@ is to be replaced by nothing, or by
//                                the numbers that relight/view_frame.js wants
import { createHash } from 'node:crypto';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const kModelPlaceholder = '@LFM_MODEL_BASE64@';
const kTitlePlaceholder = '@LFM_TITLE@';
const kPages = [
  { prefix: '', entry: 'src/app.js', template: 'page/page.html', styles: ['page/page.css'],
    model: 'model.glb' },
  { prefix: 'relight_', entry: 'relight/relight_app.js', template: 'relight/relight.html',
    styles: ['page/page.css', 'relight/relight.css'], model: 'model.lfr' },
];

const here = path.dirname(fileURLToPath(import.meta.url));

async function bundle(esbuild, nodeModules, options) {
  const result = await esbuild.build({
    bundle: true,
    absWorkingDir: here, // comments name files from here, wherever it is built
    write: false,
    minify: true,
    charset: 'ascii',
    target: ['es2022'],
    loader: { '.glsl': 'text' },
    legalComments: 'inline', // three.js's licence wants to be kept
    nodePaths: [nodeModules],
    logLevel: 'warning',
    ...options,
  });
  return result.outputFiles[0].text.trim();
}

function hashOf(text) {
  return `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
}

function fill(template, parts) {
  return template.replace(/@([A-Z]+)@/g, (_, key) => parts[key]);
}

// Browsers hash an inline element's text after they have read it as HTML.
function requireInline(text, what) {
  if (/<!--|<\/(script|style)|[\r\0]|@LFM_/i.test(text)) {
    throw new Error(`${what} cannot stand in a page as it is`);
  }
}

async function main(out, nodeModules) {
  // From the folder given: it need not be above this one.
  const esbuildFile = createRequire(path.join(nodeModules, 'x.js')).resolve('esbuild');
  const { default: esbuild } = await import(pathToFileURL(esbuildFile));
  const library = await bundle(esbuild, nodeModules, {
    entryPoints: [path.join(here, 'src/index.js')], format: 'esm', external: ['three'],
    minify: false,
  });
  await mkdir(out, { recursive: true });
  const write = (name, text) => writeFile(path.join(out, name), `${text.trimEnd()}\n`);
  await write('lfm-surface-light-field.js', library);
  for (const { prefix, ...sources } of kPages) {
    const page = await makePage(sources, (options) => bundle(esbuild, nodeModules, options));
    await write(`${prefix}index.html`, page.folder);
    await write(`${prefix}app.js`, page.app);
    await write(`${prefix}single.html`, page.single);
  }
}

/** The texts of a page: its script, and the page with it inside or beside. */
async function makePage({ entry, template: file, styles, model }, bundleApp) {
  const read = (name) => readFile(path.join(here, name), 'utf8');
  const app = await bundleApp({ entryPoints: [path.join(here, entry)], format: 'iife' });
  const template = await read(file);
  const style = (await Promise.all(styles.map(read))).join('').trim();
  requireInline(app, 'the script');
  requireInline(style, 'the style');
  const single = fill(template, {
    POLICY: `default-src 'none'; script-src ${hashOf(app)}; style-src ${hashOf(style)}; ` +
            "base-uri 'none'; form-action 'none'",
    HEAD: '',
    TITLE: kTitlePlaceholder,
    STYLE: style,
    SCRIPT: `<script>${app}</script>\n<template id="model">${kModelPlaceholder}</template>`,
  });
  const folder = fill(template, {
    POLICY: `default-src 'none'; script-src 'self'; style-src ${hashOf(style)}; ` +
            "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'",
    // Without one, browsers ask the server for favicon.ico.
    HEAD: `<meta name="model" content="${model}">\n<link rel="icon" href="data:,">`,
    TITLE: kTitlePlaceholder,
    STYLE: style,
    SCRIPT: '<script src="app.js" defer></script>',
  });
  return { app, single, folder };
}

const [out, nodeModules] = process.argv.slice(2);
if (nodeModules === undefined) {
  console.error('usage: node build.mjs OUT NODE_MODULES');
  process.exit(2);
}
await main(path.resolve(out), path.resolve(nodeModules));
