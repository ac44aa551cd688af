// SPDX-License-Identifier: BSD-3-Clause
// node validate_glb.cjs NODE_MODULES FILE: Khronos' glTF validator; fails on any error or warning,
// and on notes of other kinds than those that an unknown extension must bring.
const fs = require('fs');
const path = require('path');

const [nodeModules, file] = process.argv.slice(2);
const validator = require(path.join(nodeModules, 'gltf-validator'));
const expectedNotes = new Set(['UNSUPPORTED_EXTENSION', 'UNUSED_OBJECT', 'IMAGE_NPOT_DIMENSIONS']);

validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {maxIssues: 0}).then((report) => {
  const bad = report.issues.messages.filter((m) => m.severity < 2 || !expectedNotes.has(m.code));
  for (const m of bad) console.error(`${m.severity} ${m.code} ${m.pointer}: ${m.message}`);
  const hasExtension = report.info.extensionsUsed.includes('LFM_surface_light_field');
  const drawn = report.info.totalTriangleCount > 0 && report.info.hasTextures;
  if (!hasExtension || !drawn) console.error('no extension, or nothing to draw');
  process.exit(bad.length === 0 && hasExtension && drawn ? 0 : 1);
}).catch((error) => {
  console.error(String(error));
  process.exit(1);
});
