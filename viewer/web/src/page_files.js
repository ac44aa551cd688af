// SPDX-License-Identifier: BSD-3-Clause
// Files of a page: inside it in base64, or beside it on its server.
import { ModelError } from './model_error.js';

/** The text of a template. */
export const textOf = (element) => element.content.textContent.trim();

/**
 * The bytes of the file that a template of the page holds, which is taken out of the page; null
 * where there is none. `name` is for messages. Throws ModelError.
 */
export function takeBytes(element, name) {
  const text = element === null ? '' : textOf(element);
  if (text === '' || text.startsWith('@')) return null;
  let bytes;
  try {
    bytes = bytesOfBase64(text);
  } catch {
    throw new ModelError(`${name}: damaged; save or make the page again`);
  }
  element.remove();
  return bytes;
}

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** The response with a file beside the page. Throws ModelError. */
export async function fetchBeside(url, file) {
  let response;
  try {
    response = await fetch(url);
  } catch {
    throw new ModelError(
      window.location.protocol === 'file:'
        ? `${file}: pages on the disk may not read it; serve this folder (python3 -m http.server)`
        : `${file}: the server does not answer; load the page again`);
  }
  if (!response.ok || response.body === null) {
    throw new ModelError(`${file}: the server answers ${response.status}; ` +
                         'put the model beside index.html');
  }
  return response;
}

/** How many bytes a response says it has; 0 where it does not. */
export const declaredBytes = (response) => Number(response.headers.get('content-length') ?? 0);
