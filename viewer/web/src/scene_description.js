// SPDX-License-Identifier: BSD-3-Clause
// Reads scene files (viewer/scene.h, ReadSceneFile): which models stand where. Trusts nothing.
import { ModelError } from './model_error.js';

const kMostCharacters = 4e6;
const kMostModels = 1000;
const kMostMillimetres = 1e9;
const kLeastScale = 1e-6, kMostScale = 1e6;
const kKeys = ['file', 'translation', 'rotation', 'scale'];

/**
 * The files of a scene, in order of first mention: [{file, places}], `places` (placement.js) one or
 * more. Throws ModelError, which begins with `name`.
 */
export function parseScene(text, name) {
  const require = (condition, problem) => {
    if (!condition) throw new ModelError(`${name}: ${problem}; write the pages again`);
  };
  const { models } = readJson(text, require);
  require(Array.isArray(models) && models.length > 0, 'it lists no model');
  require(models.length <= kMostModels, `it lists more than ${kMostModels} models`);
  const files = new Map();
  models.forEach((model, i) => {
    const place = readPlace(model, (condition, problem) => require(condition, `models[${i}]${problem}`));
    if (!files.has(model.file)) files.set(model.file, []);
    files.get(model.file).push(place);
  });
  return Array.from(files, ([file, places]) => ({ file, places }));
}

function readJson(text, require) {
  require(text.length <= kMostCharacters, 'larger than a scene may be');
  let json = null;
  try {
    json = JSON.parse(text);
  } catch {
    require(false, 'damaged, or no scene');
  }
  require(isObject(json) && Object.keys(json).every((key) => key === 'models'), 'no scene');
  return json;
}

const isObject = (value) =>
  value !== null && typeof value === 'object' && !Array.isArray(value);

function readPlace(model, require) {
  require(isObject(model), ' is no object');
  for (const key of Object.keys(model)) require(kKeys.includes(key), ` has an unknown key`);
  require(isFileName(model.file), '.file names no file of this folder');
  const numbers = (key, count, otherwise) => {
    const list = Object.hasOwn(model, key) ? model[key] : otherwise;
    require(Array.isArray(list) && list.length === count && list.every(Number.isFinite),
            `.${key} is not a list of ${count} numbers`);
    return list;
  };
  const position = numbers('translation', 3, [0, 0, 0]);
  require(position.every((value) => Math.abs(value) <= kMostMillimetres),
          '.translation is more than 1e9 mm');
  const [w, x, y, z] = numbers('rotation', 4, [1, 0, 0, 0]);
  const norm = Math.hypot(w, x, y, z);
  require(Math.abs(norm - 1) <= 1e-3, '.rotation is not a unit quaternion w, x, y, z');
  const scale = Object.hasOwn(model, 'scale') ? model.scale : 1;
  require(Number.isFinite(scale) && scale >= kLeastScale && scale <= kMostScale,
          '.scale is not a number between 1e-6 and 1e6');
  return { position, quaternion: [x, y, z, w].map((value) => value / norm), scale };
}

// One line that an error can show, beside the scene or below it.
const isFileName = (file) =>
  typeof file === 'string' && /^[^/\\\p{Cc}][^\\\p{Cc}]{0,254}$/u.test(file) &&
  !file.split('/').includes('..');
