// SPDX-License-Identifier: BSD-3-Clause
// For three.js's GLTFLoader: loader.register((parser) => new LightFieldPlugin(parser)).
import { kExtension, readLightField } from './light_field.js';
import { LightFieldObject } from './light_field_object.js';

/**
 * Adds the light field to the node that has the plain mesh. The file is loaded when the mesh is;
 * the light field takes the mesh's place when its mean view can be drawn, and gains terms as the
 * scene is drawn. Then `gltf.userData.lightField` is
 *
 *   {ready, object}  ready: a promise of the LightFieldObject with all terms; it rejects when the
 *                    light field is broken (the plain mesh stays). object: null until it is there.
 *
 * Listen to `change` of the object, or call `onChange`, to draw again.
 */
export class LightFieldPlugin {
  constructor(parser, { onChange = () => {} } = {}) {
    this.name = kExtension;
    this.parser = parser;
    this.onChange = onChange;
  }

  async afterRoot(gltf) {
    if (gltf.parser.json.extensions?.[kExtension] === undefined) return;
    const state = { object: null, ready: null };
    state.ready = this.load(gltf, state);
    state.ready.catch((error) => console.warn(`THREE.GLTFLoader: ${error.message}`));
    gltf.userData.lightField = state;
  }

  async load(gltf, state) {
    const { parser } = this;
    const source = {
      json: parser.json,
      name: 'the model',
      bufferView: async (index) => new Uint8Array(await parser.getDependency('bufferView', index)),
    };
    const object = new LightFieldObject(await readLightField(source));
    const plain = findPlainMesh(gltf);
    plain.add(object);
    state.object = object;
    const failure = new Promise((_, reject) => {
      object.addEventListener('error', ({ error }) => {
        setDrawn(plain, object, true);
        queueMicrotask(() => this.onChange()); // not within the draw that failed
        reject(error);
      });
    });
    object.addEventListener('change', () => {
      if (object.mesh.visible) setDrawn(plain, object, false);
      this.onChange();
    });
    await Promise.race([object.load(source), failure]);
    return object;
  }
}

// The object of the node whose mesh shows the mean pages.
function findPlainMesh(gltf) {
  const { json, associations } = gltf.parser;
  const meanImage = json.extensions[kExtension].meanImages?.[0];
  const showsMean = (mesh) => mesh.primitives?.some((primitive) => {
    const texture = json.materials?.[primitive.material]?.pbrMetallicRoughness?.baseColorTexture;
    return texture !== undefined && json.textures?.[texture.index]?.source === meanImage;
  });
  const index = Math.max(0, json.meshes?.findIndex(showsMean) ?? 0);
  let found = null;
  gltf.scene.traverse((object) => {
    const association = associations.get(object);
    const { mesh } = json.nodes?.[association?.nodes] ?? {};
    if (found === null && mesh === index) found = object;
  });
  return found ?? gltf.scene;
}

// Not by `visible`: the light field is below the mesh.
function setDrawn(plain, object, drawn) {
  plain.traverse((child) => {
    if (child.isMesh && child !== object.mesh) child.material.visible = drawn;
  });
}
