// SPDX-License-Identifier: BSD-3-Clause
// Canvas, renderer, scene and camera; draws when something has changed, never in a loop.
import { Color, PerspectiveCamera, Raycaster, Scene, Vector2, WebGLRenderer } from 'three';
import { ModelError } from './model_error.js';
import { eyeOf, frame, lookAt, orbit, withDistance, withLimitsOf } from './orbit_camera.js';

const kMostPixelRatio = 2;
const kSoonMilliseconds = 300;
// Where the device needs this long for a draw, what moves is drawn coarsely.
const kSlowMilliseconds = 80;
const kCoarse = 0.5; // of the pixels a side
const kStillMilliseconds = 600;
const kDegree = Math.PI / 180;

export class Stage {
  /** `settings`: view_settings.js. `onDrawn` is called after each draw. */
  constructor(canvas, settings, onDrawn) {
    this.canvas = canvas;
    this.settings = settings;
    this.onDrawn = onDrawn;
    this.scene = new Scene();
    this.lens = new PerspectiveCamera();
    this.lens.up.set(0, 0, 1);
    this.bounds = null;
    this.view = null; // orbit_camera.js; null before there is something to look at
    this.touched = false; // by the user: then windows that change size do not frame again
    this.pending = this.soon = 0; // what is asked for
    this.draws = 0;
    this.coarse = false;
    this.drawMilliseconds = 0; // of the last full draw
    this.measuring = false;
    this.still = 0; // timer
    this.renderer = makeRenderer(canvas, settings.antialias !== '0');
    this.applyBackground();
    this.resize();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  applyBackground() {
    this.renderer.setClearColor(new Color(`#${this.settings.background}`), 1);
  }

  /** At what there is to see now; `bounds`: bounds.js. */
  look(bounds) {
    this.bounds = bounds;
    if (this.touched) this.view = withLimitsOf(this.view, this.framed());
    else this.home();
    this.invalidate();
  }

  /** What the settings say, of what there is to see. */
  framed() {
    const { azimuth, elevation, distance, fov } = this.settings;
    const view = frame(this.bounds, fov * kDegree, this.lens.aspect);
    const turned =
      orbit({ ...view, azimuth: 0, elevation: 0 }, azimuth * kDegree, elevation * kDegree);
    return withDistance(turned, distance);
  }

  home() {
    if (this.bounds === null) return;
    this.view = this.framed();
    this.touched = false;
    this.invalidate();
  }

  /** `edit`: from camera to camera. */
  change(edit) {
    if (this.view === null) return;
    this.view = edit(this.view);
    this.touched = true;
    if (this.drawMilliseconds > kSlowMilliseconds) this.setCoarse(true);
    clearTimeout(this.still);
    this.still = setTimeout(() => this.setCoarse(false), kStillMilliseconds);
    this.invalidate();
  }

  /** Looks at what is shown at x, y, in CSS pixels of the canvas. */
  focus(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    const at = new Vector2(2 * x / clientWidth - 1, 1 - 2 * y / clientHeight);
    const caster = new Raycaster();
    caster.setFromCamera(at, this.lens);
    const [hit] = caster.intersectObjects(this.scene.children, true);
    if (hit !== undefined) this.change((view) => lookAt(view, hit.point.toArray()));
  }

  resize() {
    const { width, height } = this.settings;
    const parent = this.canvas.parentElement;
    const size = [width ?? parent.clientWidth, height ?? parent.clientHeight]
      .map((pixels) => Math.max(1, pixels));
    this.renderer.setPixelRatio(this.pixelRatio());
    this.renderer.setSize(...size);
    this.lens.aspect = size[0] / size[1];
    if (!this.touched) this.home();
    this.draw(); // a canvas of another size is empty
  }

  pixelRatio() {
    const { width, height } = this.settings;
    if (width !== undefined && height !== undefined) return 1; // as many pixels as are asked for
    return Math.min(window.devicePixelRatio, kMostPixelRatio) * (this.coarse ? kCoarse : 1);
  }

  setCoarse(coarse) {
    if (this.coarse === coarse) return;
    this.coarse = coarse;
    this.renderer.setPixelRatio(this.pixelRatio());
    this.draw();
  }

  /** Draws with the next picture of the screen. */
  invalidate() {
    if (this.pending !== 0) return;
    this.pending = requestAnimationFrame(() => this.draw());
  }

  /** Draws within a moment, unless something else draws before. */
  invalidateSoon() {
    if (this.soon !== 0) return;
    this.soon = setTimeout(() => this.invalidate(), kSoonMilliseconds);
  }

  draw() {
    cancelAnimationFrame(this.pending);
    clearTimeout(this.soon);
    this.pending = this.soon = 0;
    if (this.view !== null) this.placeLens();
    this.renderer.render(this.scene, this.lens);
    ++this.draws;
    this.measureDraw();
    this.onDrawn();
  }

  /** Draws go on after they were asked for: only a fence tells when one is done. */
  measureDraw() {
    if (this.coarse || this.measuring) return;
    this.measuring = true;
    const gl = this.renderer.getContext();
    const begun = performance.now();
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
    };
    setTimeout(look);
  }

  /**
   * The median milliseconds of `count` draws in all pixels, each turned by a degree and waited for.
   * The view stays. Pages that still arrive would be counted in.
   */
  async measureFrames(count) {
    if (!Number.isInteger(count) || count < 1) throw new RangeError('how many frames?');
    if (this.view === null) throw new ModelError('there is nothing to draw yet');
    this.setCoarse(false);
    const gl = this.renderer.getContext(), pixel = new Uint8Array(4), { view } = this;
    const milliseconds = [];
    try {
      for (let frame = 1; frame <= count; ++frame) {
        this.view = orbit(view, frame * kDegree, 0);
        const begun = performance.now();
        this.placeLens();
        this.renderer.render(this.scene, this.lens);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // there when all is drawn
        milliseconds.push(performance.now() - begun);
        await new Promise((resolve) => setTimeout(resolve)); // the page stays alive
      }
    } finally {
      this.view = view;
      this.draw();
    }
    milliseconds.sort((a, b) => a - b);
    return (milliseconds[(count - 1) >> 1] + milliseconds[count >> 1]) / 2;
  }

  placeLens() {
    const { view, lens } = this;
    lens.position.set(...eyeOf(view));
    lens.lookAt(...view.target);
    const toCenter = view.center.map((value, i) => value - lens.position.getComponent(i));
    const direction = lens.getWorldDirection(lens.position.clone()).toArray();
    const depth = toCenter.reduce((sum, value, i) => sum + value * direction[i], 0);
    const far = Math.max(depth + 1.01 * view.radius, 1e-3 * view.radius);
    lens.near = Math.max(depth - 1.01 * view.radius, 1e-3 * far);
    lens.far = far;
    lens.fov = view.verticalFov / kDegree;
    lens.updateProjectionMatrix();
  }

  /** The picture as the URL of a PNG. */
  picture() {
    this.setCoarse(false);
    this.draw();
    return this.canvas.toDataURL('image/png');
  }
}

function makeRenderer(canvas, antialias) {
  const context = canvas.getContext('webgl2', { antialias, alpha: false });
  if (context === null) {
    throw new ModelError('this browser or device does not offer WebGL 2; ' +
                         'switch on hardware acceleration, or try another browser');
  }
  return new WebGLRenderer({ canvas, context });
}
