// SPDX-License-Identifier: BSD-3-Clause
// The maps of a model as texture arrays, filled page by page as pages arrive.
import { ExternalTexture } from 'three';
import { decodeBc1, decodeBc4Planes } from './block_decoding.js';
import { ModelError } from './model_error.js';

const kMaxArrayTexels = 2 ** 28; // 1 GiB uncompressed

/**
 * One texture array. `pages`, `needs`: flat lists (page_lists.js, page_needs.js). `planes` is how
 * many layers a page takes: 3 for BC4 that the device reads, else 1.
 */
class MapArray {
  constructor(what, pages, needs) {
    this.what = what;
    this.blockPlanes = pages[0]?.planes ?? 0;
    // Blocks are uploaded whole; of pictures only what is named.
    const sizes = this.blockPlanes > 0 ? pages : needs;
    const unit = this.blockPlanes > 0 ? 4 : 1;
    this.width = Math.max(unit, ...sizes.map((size) => size.width));
    this.height = Math.max(unit, ...sizes.map((size) => size.height));
    this.pageCount = pages.length;
    this.planes = 1;
    this.format = null; // of blocks, where the device reads them
    this.texture = new ExternalTexture();
  }

  get layers() {
    return Math.max(1, this.pageCount * this.planes);
  }

  allocate(gl, state, name, decodeBlocks) {
    if (this.blockPlanes > 0 && !decodeBlocks) this.format = blockFormat(gl, this.blockPlanes);
    this.planes = this.format === null ? 1 : this.blockPlanes;
    this.check(gl, name);
    const texture = gl.createTexture();
    this.texture.sourceTexture = texture;
    state.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    const set = (key, value) => gl.texParameteri(gl.TEXTURE_2D_ARRAY, key, value);
    set(gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    set(gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    set(gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    set(gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, this.format ?? gl.RGBA8, this.width, this.height,
                    this.layers);
    if (gl.getError() === gl.OUT_OF_MEMORY) {
      throw new ModelError(`${name}: this device has too little graphics memory for the model; ` +
                           'encode again with fewer terms or --blocks');
    }
  }

  check(gl, name) {
    const side = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    const layers = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
    if (this.width > side || this.height > side) {
      throw new ModelError(
        `${name}: its ${this.what} pages are ${this.width}x${this.height} texels and this ` +
        `device takes ${side}; encode again with --max-texture-size ${side}`);
    }
    if (this.layers > layers) {
      throw new ModelError(`${name}: it has ${this.layers} ${this.what} pages and this device ` +
                           `takes ${layers}; encode again with a larger --max-texture-size`);
    }
    if (this.width * this.height * this.layers > kMaxArrayTexels) {
      throw new ModelError(`${name}: its ${this.what} pages take more memory than a browser ` +
                           'gives; encode again with fewer terms');
    }
  }

  upload(gl, state, index, page) {
    state.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture.sourceTexture);
    if (page.image) {
      // The picture may be larger than what is named of it: its upper left part is taken.
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, index, Math.min(page.width, this.width),
                       Math.min(page.height, this.height), 1, gl.RGBA, gl.UNSIGNED_BYTE,
                       page.image);
      page.image.close();
    } else if (this.format === null) {
      const decode = page.planes === 1 ? decodeBc1 : decodeBc4Planes;
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, index, page.width, page.height, 1, gl.RGBA,
                       gl.UNSIGNED_BYTE, decode(page.blocks, page.width, page.height));
    } else {
      const bytes = page.width * page.height / 2;
      for (let plane = 0; plane < this.planes; ++plane) {
        gl.compressedTexSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, index * this.planes + plane,
                                   page.width, page.height, 1, this.format,
                                   page.blocks.subarray(plane * bytes, (plane + 1) * bytes));
      }
    }
  }

  dispose(gl) {
    if (gl !== null && this.texture.sourceTexture) gl.deleteTexture(this.texture.sourceTexture);
    this.texture.dispose();
  }
}

function blockFormat(gl, planes) {
  if (planes === 1) {
    return gl.getExtension('WEBGL_compressed_texture_s3tc')?.COMPRESSED_RGB_S3TC_DXT1_EXT ?? null;
  }
  return gl.getExtension('EXT_texture_compression_rgtc')?.COMPRESSED_RED_RGTC1_EXT ?? null;
}

/**
 * The three arrays of a light field (light_field.js). Pages are queued in the order in which they
 * are to be seen, mean view first, then term by term, and go to the device within draws
 * (upload_queue.js). `decodeBlocks`: as if the device read no compressed textures.
 */
export class MapTextures {
  constructor(field, { decodeBlocks = false } = {}) {
    this.name = field.name;
    this.decodeBlocks = decodeBlocks;
    const { pages, needs } = field;
    this.mean = new MapArray('mean', pages.mean, needs.mean);
    this.surface = new MapArray('surface', pages.surface.flat(), needs.surface.flat());
    this.view = new MapArray('view', pages.view.flat(), needs.view.flat());
    this.surfaceFirst = firstOfLists(pages.surface);
    this.viewFirst = firstOfLists(pages.view);
    this.queue = [];
    this.gl = null;
    /** Terms whose pages the device has; -1: not even the mean view. */
    this.loadedTerms = -1;
  }

  addMean(pages) {
    pages.forEach((page, i) => this.queue.push({ array: this.mean, index: i, page }));
    this.queue.push({ loadedTerms: 0 });
  }

  addTerm(term, surfacePages, viewPages) {
    const add = (array, first, pages) =>
      pages.forEach((page, i) => this.queue.push({ array, index: first[term] + i, page }));
    add(this.surface, this.surfaceFirst, surfacePages);
    add(this.view, this.viewFirst, viewPages);
    this.queue.push({ loadedTerms: term + 1 });
  }

  get texelsWaiting() {
    return this.queue.reduce((sum, { page }) => sum + (page ? page.width * page.height : 0), 0);
  }

  /** Sends the first page of the queue to the device. */
  uploadPage(renderer) {
    const gl = renderer.getContext(), { state } = renderer;
    if (this.gl === null) {
      this.gl = gl;
      for (const array of [this.mean, this.surface, this.view]) {
        array.allocate(gl, state, this.name, this.decodeBlocks);
      }
    }
    const { array, index, page, loadedTerms } = this.queue.shift();
    if (page) array.upload(gl, state, index, page);
    else this.loadedTerms = loadedTerms;
  }

  dispose() {
    for (const { page } of this.queue) page?.image?.close();
    this.queue = [];
    for (const array of [this.mean, this.surface, this.view]) array.dispose(this.gl);
  }
}

function firstOfLists(lists) {
  let pages = 0;
  return lists.map((list) => (pages += list.length) - list.length);
}
