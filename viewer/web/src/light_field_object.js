// SPDX-License-Identifier: BSD-3-Clause
// A light field as an object of a three.js scene.
import {
  BufferAttribute, BufferGeometry, LinearSRGBColorSpace, Matrix4, Mesh, Object3D, SRGBColorSpace,
  Vector3,
} from 'three';
import { makeLightFieldMaterial } from './light_field_material.js';
import { MapTextures } from './map_textures.js';
import { ModelError } from './model_error.js';
import { decodePage, TexelBudget } from './page_decoding.js';

// Pages are sent to the device for a quarter of the time from draw to draw, within these limits.
const kLeastUploadMilliseconds = 12, kMostUploadMilliseconds = 100;
const kMostTexelsWaiting = 2 ** 25; // decoded, not yet sent: 128 MB

/**
 * Draws a light field (light_field.js) in its own frame: mm, z up. Pages arrive by `load`.
 *
 *   terms        how many terms are wanted; 0 is the mean view. All at first.
 *   loadedTerms  how many can be drawn; -1 before the mean view, when nothing is drawn
 *
 * Events: 'change' when another draw would show more ({urgent}: the mean view, or the last terms),
 * 'error' ({error}) when a draw failed.
 * Colours are sRGB-coded on a canvas and linear in render targets, as three.js has them; lights
 * and tone mapping do not change them. `decodeBlocks`: see map_textures.js.
 */
export class LightFieldObject extends Object3D {
  constructor(field, options = {}) {
    super();
    this.type = 'LightFieldObject';
    this.field = field;
    this.terms = field.terms;
    this.failed = false;
    this.maps = new MapTextures(field, options);
    const { geometry, center } = makeGeometry(field);
    this.mesh = new Mesh(geometry, makeLightFieldMaterial(field, this.maps));
    this.mesh.position.copy(center);
    this.mesh.visible = false;
    this.mesh.onBeforeRender = (renderer, scene, camera) => this.prepare(renderer, camera);
    this.add(this.mesh);
    this.afterUpload = [];
    this.allQueued = false;
    this.lastDraw = 0; // performance.now()
  }

  get loadedTerms() {
    return this.maps.loadedTerms;
  }

  /** Terms that a draw shows now. */
  get shownTerms() {
    return Math.max(0, Math.min(this.terms, this.loadedTerms));
  }

  /**
   * Decodes the pages of `source`, mean view first, then term by term; resolves when all have
   * been drawn with. Terms wait while nobody draws.
   */
  async load(source) {
    const { pages, needs, terms } = this.field;
    const budget = new TexelBudget(source.name);
    const all = (list, needed) =>
      Promise.all(list.map((page, i) => decodePage(source, page, needed[i], budget)));
    this.maps.addMean(await all(pages.mean, needs.mean));
    this.allQueued = terms === 0;
    this.mesh.visible = true;
    this.noteChange();
    for (let k = 0; k < terms; ++k) {
      const [surface, view] = await Promise.all([
        all(pages.surface[k], needs.surface[k]), all(pages.view[k], needs.view[k]),
      ]);
      this.maps.addTerm(k, surface, view);
      this.allQueued = k + 1 === terms;
      this.noteChange();
      await this.until(() => this.maps.texelsWaiting <= kMostTexelsWaiting);
    }
    await this.until(() => this.loadedTerms >= terms);
  }

  noteChange() {
    this.dispatchEvent({ type: 'change', urgent: this.allQueued || this.loadedTerms < 0 });
  }

  async until(condition) {
    while (!condition() && !this.failed) {
      await new Promise((resolve) => this.afterUpload.push(resolve));
    }
  }

  prepare(renderer, camera) {
    try {
      this.uploadPages(renderer);
    } catch (error) {
      this.failed = true;
      this.mesh.visible = false;
      this.dispatchEvent({ type: 'error', error });
    }
    this.lastDraw = performance.now();
    const { uniforms } = this.mesh.material;
    uniforms.terms.value = this.shownTerms;
    uniforms.surface_planes.value = this.maps.surface.planes;
    const camera_from_model =
      new Matrix4().multiplyMatrices(camera.matrixWorldInverse, this.mesh.matrixWorld);
    uniforms.clip_from_model.value.multiplyMatrices(camera.projectionMatrix, camera_from_model);
    uniforms.eye.value.set(0, 0, 0).applyMatrix4(camera_from_model.invert());
    const target = renderer.getRenderTarget();
    const outputColorSpace = target === null ? renderer.outputColorSpace
      : target.isXRRenderTarget ? target.texture.colorSpace : LinearSRGBColorSpace;
    uniforms.linear_output.value = outputColorSpace === SRGBColorSpace ? 0 : 1;
    this.mesh.material.uniformsNeedUpdate = true;
  }

  uploadPages(renderer) {
    if (this.failed || this.maps.queue.length === 0) return;
    if (this.loadedTerms < 0) checkTables(renderer, this.mesh.material, this.field.name);
    const since = performance.now() - this.lastDraw;
    this.maps.upload(renderer, Math.min(Math.max(since / 4, kLeastUploadMilliseconds),
                                        kMostUploadMilliseconds));
    for (const resolve of this.afterUpload.splice(0)) resolve();
    // Not within a draw: listeners may want to draw at once.
    queueMicrotask(() => this.noteChange());
  }

  /** Frees what the device holds; the object cannot be drawn any more. */
  dispose() {
    this.failed = true;
    this.mesh.visible = false;
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.maps.dispose();
    for (const resolve of this.afterUpload.splice(0)) resolve();
  }
}

function checkTables(renderer, material, name) {
  const most = renderer.capabilities.maxTextureSize;
  for (const key of ['frames', 'ranges', 'patches', 'tiles']) {
    if (material.uniforms[key].value.image.height > most) {
      throw new ModelError(`${name}: it has more triangles than this device takes; ` +
                           'reduce the mesh and encode again');
    }
  }
}

// Three corners a triangle, relative to the centre of the mesh: single precision is enough there.
function makeGeometry(field) {
  const { vertices, triangles } = field;
  const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
  const vertex = new Vector3();
  for (let i = 0; i < vertices.length; i += 3) {
    vertex.fromArray(vertices, i);
    low.min(vertex);
    high.max(vertex);
  }
  const center = low.add(high).multiplyScalar(0.5);
  const positions = new Float32Array(3 * triangles.length);
  const corners = new Int32Array(3 * triangles.length);
  const numbers = new Int32Array(triangles.length);
  triangles.forEach((v, c) => {
    const t = Math.floor(c / 3);
    positions[3 * c] = vertices[3 * v] - center.x;
    positions[3 * c + 1] = vertices[3 * v + 1] - center.y;
    positions[3 * c + 2] = vertices[3 * v + 2] - center.z;
    for (let j = 0; j < 3; ++j) corners[3 * c + j] = triangles[3 * t + j];
    numbers[c] = t;
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('corners', new BufferAttribute(corners, 3));
  geometry.setAttribute('triangle', new BufferAttribute(numbers, 1));
  geometry.computeBoundingSphere();
  return { geometry, center };
}
