// SPDX-License-Identifier: BSD-3-Clause
// The picture on its canvas, by WebGL 2; draws when something has changed, never in a loop.
import { ModelError } from '../src/model_error.js';
import { makeTables } from './model_tables.js';
import { kFragmentShader, kTableWidth, kVertexShader } from './relighting_shader.js';

const kMostProduct = 1e28; // sums of 65536 of them are float32 numbers still
const kSlowMilliseconds = 80; // a draw
const kStillMilliseconds = 400;
const kCoarse = 2; // pixels a side that are drawn as one while something moves on a slow device

export class RelitPicture {
  /** `onDrawn` is called after each draw, and once it is known how long it took. */
  constructor(canvas, onDrawn) {
    this.canvas = canvas;
    this.onDrawn = onDrawn;
    this.gl = canvas.getContext('webgl2', { antialias: false, alpha: false, depth: false });
    if (this.gl === null) {
      throw new ModelError('this browser or device does not offer WebGL 2; ' +
                           'switch on hardware acceleration, or try another browser');
    }
    this.model = null;
    this.residuals = 0; // at most so many of a pixel and channel
    this.pending = this.draws = this.drawMilliseconds = 0;
    this.coarse = this.measuring = false;
    this.slow = false; // as if the device were slow
    this.still = 0; // timer
  }

  /** Throws ModelError where the device cannot hold the model. */
  setModel(model) {
    const { gl } = this;
    const most = Math.min(gl.getParameter(gl.MAX_TEXTURE_SIZE), gl.getParameter(gl.MAX_VIEWPORT_DIMS)[0]);
    const { width, height, channels } = model;
    if (Math.max(width, height) > most) {
      throw new ModelError(`the picture of ${width} x ${height} pixels is larger than this device ` +
                           `can draw (${most} a side)`);
    }
    this.program = makeProgram(gl);
    const tables = makeTables(model);
    this.textures = {
      rows: makeTexture(gl, gl.TEXTURE_2D_ARRAY),
      weights: makeTexture(gl, gl.TEXTURE_2D),
      residuals: makeTexture(gl, gl.TEXTURE_2D),
      products: makeTexture(gl, gl.TEXTURE_2D),
      light: makeTexture(gl, gl.TEXTURE_2D),
    };
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.textures.rows);
    gl.texImage3D(gl.TEXTURE_2D_ARRAY, 0, gl.RGBA32UI, width, height, channels, 0,
                  gl.RGBA_INTEGER, gl.UNSIGNED_INT, tables.rows);
    const { RGBA16F, RGBA, HALF_FLOAT, RGBA32UI, RGBA_INTEGER, UNSIGNED_INT } = gl;
    this.fill('weights', tables.weights, [RGBA16F, RGBA, HALF_FLOAT]);
    this.fill('residuals', tables.residuals, [RGBA32UI, RGBA_INTEGER, UNSIGNED_INT]);
    if (gl.getError() !== gl.NO_ERROR) {
      throw new ModelError('the model does not fit into the graphics memory of this device');
    }
    this.model = model;
  }

  /** A table as a texture, of numbers in fours. */
  fill(name, values, [internal, format, type]) {
    const { gl } = this, entries = values.length / 4;
    const height = Math.max(1, Math.ceil(entries / kTableWidth));
    if (height > gl.getParameter(gl.MAX_TEXTURE_SIZE)) {
      throw new ModelError(`the model has more ${name} than this device can hold; ` +
                           'encode it with fewer');
    }
    let padded = values;
    if (values.length !== 4 * kTableWidth * height) {
      padded = new values.constructor(4 * kTableWidth * height);
      padded.set(values);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.textures[name]);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, kTableWidth, height, 0, format, type, padded);
  }

  /** `prepared`: of evaluation.js; `gain` multiplies all that is shown. */
  setLight(prepared, gain) {
    const { gl, model } = this;
    const inFours = (values, scale) => {
      const entries = new Float32Array(4 * values[0].length);
      values.forEach((own, c) => own.forEach((value, i) => {
        entries[4 * i + c] = Math.max(-kMostProduct, Math.min(kMostProduct, value * scale));
      }));
      return entries;
    };
    const form = [gl.RGBA32F, gl.RGBA, gl.FLOAT];
    this.fill('products', inFours(prepared.map(({ products }) => products),
                                  gain * 2 ** model.weightExponent), form);
    this.fill('light', inFours(prepared.map(({ coefficients }) => coefficients),
                               gain * 2 ** model.residualExponent), form);
    this.change();
  }

  setResiduals(residuals) {
    this.residuals = residuals;
    this.change();
  }

  /** Draws with the next picture of the screen: fewer pixels and residuals where that is slow. */
  change() {
    if (this.slow || this.drawMilliseconds > kSlowMilliseconds) this.coarse = true;
    clearTimeout(this.still);
    this.still = setTimeout(() => {
      if (!this.coarse) return;
      this.coarse = false;
      this.draw();
    }, kStillMilliseconds);
    if (this.pending === 0) this.pending = requestAnimationFrame(() => this.draw());
  }

  /** How many residuals are drawn now. */
  get drawnResiduals() {
    return this.coarse ? this.residuals >> 2 : this.residuals;
  }

  draw() {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    if (this.model === null) return;
    this.drawNow();
    ++this.draws;
    this.measureDraw();
    this.onDrawn();
  }

  drawNow() {
    const { gl, program, model, canvas } = this, step = this.coarse ? kCoarse : 1;
    const [width, height] = [model.width, model.height].map((side) => Math.ceil(side / step));
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    gl.viewport(0, 0, width, height);
    gl.useProgram(program);
    Object.entries(this.textures).forEach(([name, texture], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(name === 'rows' ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, texture);
      gl.uniform1i(gl.getUniformLocation(program, name), unit);
    });
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1ui(gl.getUniformLocation(program, 'most_residuals'), this.drawnResiduals);
    gl.uniform1i(gl.getUniformLocation(program, 'channels'), model.channels);
    gl.uniform1i(gl.getUniformLocation(program, 'height'), height);
    gl.uniform1i(gl.getUniformLocation(program, 'pixel_step'), step);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** Draws go on after they were asked for: only a fence tells when one is done. */
  measureDraw() {
    if (this.coarse || this.measuring) return;
    this.measuring = true;
    const { gl } = this, begun = performance.now();
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED) {
        setTimeout(look, 4);
        return;
      }
      gl.deleteSync(fence);
      this.drawMilliseconds = performance.now() - begun;
      this.measuring = false;
      this.onDrawn();
    };
    setTimeout(look);
  }

  /** The median milliseconds of `count` draws with all residuals that are asked for, each waited for. */
  async measureFrames(count) {
    if (!Number.isInteger(count) || count < 1) throw new RangeError('how many frames?');
    if (this.model === null) throw new ModelError('there is nothing to draw yet');
    this.coarse = false;
    const { gl } = this, pixel = new Uint8Array(4), milliseconds = [];
    for (let frame = 0; frame < count; ++frame) {
      const begun = performance.now();
      this.drawNow();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // there when all is drawn
      milliseconds.push(performance.now() - begun);
      await new Promise((resolve) => setTimeout(resolve)); // the page stays alive
    }
    this.draw();
    milliseconds.sort((a, b) => a - b);
    return (milliseconds[(count - 1) >> 1] + milliseconds[count >> 1]) / 2;
  }

  /** The picture as the URL of a PNG. */
  picture() {
    this.coarse = false;
    this.draw();
    return this.canvas.toDataURL('image/png');
  }
}

function makeTexture(gl, target) {
  const texture = gl.createTexture();
  gl.bindTexture(target, texture);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
}

function makeProgram(gl) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, kVertexShader],
                                [gl.FRAGMENT_SHADER, kFragmentShader]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new ModelError('the graphics driver of this device does not take the shader ' +
                         `(${firstLine(gl.getProgramInfoLog(program))})`);
  }
  return program;
}

const firstLine = (text) => (text ?? '').split('\n')[0].slice(0, 80);
