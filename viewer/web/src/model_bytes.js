// SPDX-License-Identifier: BSD-3-Clause
// Where the page has its model: inside itself, or beside it.
import { GlbSource } from './glb_source.js';
import { ModelError } from './model_error.js';

/** The GLB source of this page. `onProgress(share)`: 0 to 1. */
export function openModel(onProgress) {
  const inside = document.getElementById('model');
  if (inside !== null) return openInside(inside);
  const name = document.querySelector('meta[name=model]')?.content ?? 'model.glb';
  return openBeside(name, onProgress);
}

function openInside(element) {
  const name = 'the model in this page';
  const text = element.content.textContent.trim();
  if (text === '' || text.startsWith('@')) throw new ModelError('there is no model in this page');
  let bytes;
  try {
    bytes = bytesOfBase64(text);
  } catch {
    throw new ModelError(`${name}: damaged; save or make the page again`);
  }
  element.remove();
  return GlbSource.fromBytes(bytes, name);
}

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function openBeside(name, onProgress) {
  let response;
  try {
    response = await fetch(name);
  } catch {
    throw new ModelError(
      window.location.protocol === 'file:'
        ? `${name}: pages on the disk may not read it; serve this folder (python3 -m http.server)`
        : `${name}: the server does not answer; load the page again`);
  }
  if (!response.ok || response.body === null) {
    throw new ModelError(`${name}: the server answers ${response.status}; ` +
                         'put the model beside index.html');
  }
  return GlbSource.fromStream(response.body, name, {
    declaredBytes: Number(response.headers.get('content-length') ?? 0),
    onProgress: (bytes, total) => onProgress(Math.min(1, bytes / Math.max(total, 1))),
  });
}
