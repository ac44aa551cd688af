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
import { UploadQueue } from './upload_queue.js';

/**
 * Draws a light field (light_field.js) in its own frame: mm, z up. Pages arrive by `load`.
 *
 *   terms        how many terms are wanted; 0 is the mean view. All at first.
 *   loadedTerms  how many can be drawn; -1 before the mean view, when nothing is drawn
 *
 * Events: 'change' when another draw would show more ({urgent}: the mean view, or the last terms),
 * 'error' ({error}) when a draw failed.
 * Colours are sRGB-coded on a canvas and linear in render targets, as three.js has them; lights
 * and tone mapping do not change them. Objects above it may turn, move, and scale it alike in all
 * directions. `uploads`: an UploadQueue, when several load together; `decodeBlocks`: see
 * map_textures.js.
 */
export class LightFieldObject extends Object3D {
  constructor(field, { uploads = new UploadQueue(), ...options } = {}) {
    super();
    this.type = 'LightFieldObject';
    this.field = field;
    this.terms = field.terms;
    this.failed = false;
    this.allQueued = false;
    this.maps = new MapTextures(field, options);
    this.uploads = uploads;
    this.budget = new TexelBudget(field.name);
    const { geometry, center } = makeGeometry(field);
    this.mesh = new Mesh(geometry, makeLightFieldMaterial(field, this.maps));
    this.mesh.position.copy(center);
    this.mesh.visible = false;
    this.mesh.frustumCulled = false; // until all is loaded, for which it has to be drawn
    this.meshes = [];
    this.addMesh(this, this.mesh);
    uploads.add(this);
  }

  addMesh(parent, mesh) {
    mesh.visible = this.mesh.visible;
    mesh.onBeforeRender = (renderer, scene, camera) => this.prepare(renderer, camera, mesh);
    this.meshes.push(mesh);
    parent.add(mesh);
  }

  /** The same light field for a second place: it loads, shows terms and is freed with this one. */
  another() {
    const place = new Object3D();
    const mesh = new Mesh(this.mesh.geometry, this.mesh.material);
    mesh.position.copy(this.mesh.position);
    this.addMesh(place, mesh);
    return place;
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
    await this.loadMean(source);
    for (let k = 0; k < this.field.terms; ++k) {
      await this.loadTerm(source, k);
      await this.uploads.until(() => this.failed || !this.uploads.full);
    }
    await this.uploads.until(() => this.failed || this.loadedTerms >= this.field.terms);
  }

  /** The first part of `load`; resolves when the pages wait to be drawn with. */
  async loadMean(source) {
    const { pages, needs, terms } = this.field;
    this.maps.addMean(await this.decodeAll(source, pages.mean, needs.mean));
    this.allQueued = terms === 0;
    this.setVisible(!this.failed);
    this.noteChange();
  }

  /** The next part of `load`; `k` is the first time 0. */
  async loadTerm(source, k) {
    const { pages, needs, terms } = this.field;
    const [surface, view] = await Promise.all([
      this.decodeAll(source, pages.surface[k], needs.surface[k]),
      this.decodeAll(source, pages.view[k], needs.view[k]),
    ]);
    this.maps.addTerm(k, surface, view);
    this.allQueued = k + 1 === terms;
    this.noteChange();
  }

  decodeAll(source, list, needed) {
    return Promise.all(list.map((page, i) => decodePage(source, page, needed[i], this.budget)));
  }

  setVisible(visible) {
    for (const mesh of this.meshes) mesh.visible = visible;
  }

  noteChange() {
    this.dispatchEvent({ type: 'change', urgent: this.allQueued || this.loadedTerms < 0 });
  }

  prepare(renderer, camera, mesh) {
    this.uploads.upload(renderer);
    const { uniforms } = mesh.material;
    uniforms.terms.value = this.shownTerms;
    uniforms.surface_planes.value = this.maps.surface.planes;
    // Exact in the model's frame, where the shader takes directions, whatever stands above it.
    const camera_from_model =
      new Matrix4().multiplyMatrices(camera.matrixWorldInverse, mesh.matrixWorld);
    uniforms.clip_from_model.value.multiplyMatrices(camera.projectionMatrix, camera_from_model);
    uniforms.eye.value.set(0, 0, 0).applyMatrix4(camera_from_model.invert());
    const target = renderer.getRenderTarget();
    const outputColorSpace = target === null ? renderer.outputColorSpace
      : target.isXRRenderTarget ? target.texture.colorSpace : LinearSRGBColorSpace;
    uniforms.linear_output.value = outputColorSpace === SRGBColorSpace ? 0 : 1;
    mesh.material.uniformsNeedUpdate = true;
  }

  /** Called by the UploadQueue, within a draw. */
  uploadPage(renderer) {
    try {
      if (this.loadedTerms < 0) checkTables(renderer, this.mesh.material, this.field.name);
      this.maps.uploadPage(renderer);
      this.mesh.frustumCulled = this.loadedTerms >= this.field.terms;
    } catch (error) {
      this.stop();
      this.dispatchEvent({ type: 'error', error });
    }
  }

  stop() {
    this.failed = true;
    this.setVisible(false);
    this.uploads.remove(this);
  }

  /** Frees what the device holds; the object cannot be drawn any more. */
  dispose() {
    this.stop();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.maps.dispose();
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
