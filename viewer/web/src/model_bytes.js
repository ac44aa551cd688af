// SPDX-License-Identifier: BSD-3-Clause
// Where the page has its models: inside itself, or beside it.
import { GlbSource } from './glb_source.js';
import { ModelError } from './model_error.js';
import { declaredBytes, fetchBeside, takeBytes, textOf } from './page_files.js';
import { kWhereItIs } from './placement.js';
import { parseScene } from './scene_description.js';

/**
 * The models of this page, [{name, places, open}]: `name` for people; `places` (placement.js) where
 * it stands; `open(note)` a promise of its GLB source, `note(share)` tells how much is here, 0 to 1.
 *
 * Inside: the scene is the text of the element "scene", each file that it names that of a template
 * with `data-file`; one model where it is that of the element "model". Beside: <meta name="model">
 * names the model, or the scene (.json) whose files lie beside it.
 */
export async function findModels() {
  const scene = document.getElementById('scene');
  if (scene !== null) {
    return parseScene(textOf(scene), 'the scene in this page').map(({ file, places }) => {
      const name = `${file} in this page`;
      return { name, places, open: async () => openInside(elementOfFile(file), name) };
    });
  }
  const model = document.getElementById('model');
  if (model !== null) {
    const name = 'the model in this page';
    return [{ name, places: [kWhereItIs], open: async () => openInside(model, name) }];
  }
  const name = document.querySelector('meta[name=model]')?.content ?? 'model.glb';
  const url = new URL(name, document.baseURI);
  if (!url.pathname.endsWith('.json')) {
    return [{ name, places: [kWhereItIs], open: (note) => openBeside(url, name, note) }];
  }
  const text = await (await fetchBeside(url, name)).text();
  return parseScene(text, name).map(({ file, places }) => {
    const path = file.split('/').map(encodeURIComponent).join('/');
    return { name: file, places, open: (note) => openBeside(new URL(path, url), file, note) };
  });
}

function elementOfFile(file) {
  const elements = [...document.querySelectorAll('template[data-file]')];
  return elements.find((element) => element.dataset.file === file) ?? null;
}

function openInside(element, name) {
  const bytes = takeBytes(element, name);
  if (bytes === null) {
    throw new ModelError(element?.id === 'model' ? 'there is no model in this page'
      : `${name}: not there; make the page again`);
  }
  return GlbSource.fromBytes(bytes, name);
}

async function openBeside(url, file, note) {
  const response = await fetchBeside(url, file);
  return GlbSource.fromStream(response.body, file, {
    declaredBytes: declaredBytes(response),
    onProgress: (bytes, total) => note(Math.min(1, bytes / Math.max(total, 1))),
  });
}
