// SPDX-License-Identifier: BSD-3-Clause
// Where the page has its model.lfr: inside itself, or beside it.
import { ModelError } from '../src/model_error.js';
import { declaredBytes, fetchBeside, takeBytes } from '../src/page_files.js';

/**
 * {bytes, name}: of the template "model", or of the file that <meta name="model"> names. `note` is
 * told how much is here, 0 to 1. Throws ModelError.
 */
export async function loadModel(note) {
  const inside = document.getElementById('model');
  if (inside !== null) {
    const name = 'the model in this page';
    const bytes = takeBytes(inside, name);
    if (bytes === null) throw new ModelError('there is no model in this page');
    return { bytes, name };
  }
  const name = document.querySelector('meta[name=model]')?.content ?? 'model.lfr';
  const response = await fetchBeside(new URL(name, document.baseURI), name);
  return { bytes: await readAll(response, name, note), name };
}

async function readAll(response, name, note) {
  const parts = [], declared = declaredBytes(response), reader = response.body.getReader();
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read().catch(() => {
      throw new ModelError(`${name}: the connection broke; load the page again`);
    });
    if (done) break;
    parts.push(value);
    length += value.length;
    note(Math.min(1, length / Math.max(declared, 1)));
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}
