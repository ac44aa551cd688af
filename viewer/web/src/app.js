// SPDX-License-Identifier: BSD-3-Clause
// The page: shows its model and lets it be turned.
import { readLightField } from './light_field.js';
import { LightFieldObject } from './light_field_object.js';
import { openModel } from './model_bytes.js';
import { ModelError } from './model_error.js';
import { boundsOf } from './orbit_camera.js';
import { listenForOrbit } from './orbit_input.js';
import { Panel } from './panel.js';
import { PlainMesh } from './plain_mesh.js';
import { Stage } from './stage.js';
import { readSettings } from './view_settings.js';

const kDegree = Math.PI / 180;

class App {
  constructor(panel) {
    this.panel = panel;
    this.settings = readSettings(window.location.hash);
    this.object = null; // LightFieldObject, once its tables are read
    this.plain = new PlainMesh();
    this.wanted = { terms: Infinity, meanOnly: false };
    this.times = {}; // ms since the page was asked for
    this.bytesShare = 1;
    this.error = null;
    const canvas = document.getElementById('picture');
    this.stage = new Stage(canvas, this.settings, () => this.noteDrawn());
    this.listen(canvas);
    this.applyLook();
  }

  listen(canvas) {
    const home = () => this.stage.home();
    listenForOrbit(canvas, {
      change: (edit) => {
        this.panel.hideHint();
        this.stage.change(edit);
      },
      focus: (x, y) => this.stage.focus(x, y),
      home,
      shy: window.parent !== window,
    });
    this.panel.listen({
      setTerms: (terms) => this.want({ terms, meanOnly: false }),
      toggleMean: () => this.want({ meanOnly: !this.wanted.meanOnly }),
      home,
    });
    canvas.addEventListener('webglcontextlost', () => {
      this.fail(new ModelError('the device took its graphics memory away; load the page again'));
    });
    canvas.addEventListener('webglcontextrestored', () => window.location.reload());
    window.addEventListener('hashchange', () => this.set(readSettings(window.location.hash)));
  }

  async show() {
    // In the single file the model stands behind this script: what needs no model is done by now.
    if (document.readyState === 'loading') {
      await new Promise((resolve) => document.addEventListener('DOMContentLoaded', resolve));
    }
    this.times.pageRead = performance.now();
    const source = await openModel((share) => this.noteBytes(share));
    this.times.modelOpen = performance.now();
    if (!source.whole) this.showPlainMesh(source);
    const field = await readLightField(source);
    this.times.tablesRead = performance.now();
    const object = new LightFieldObject(field, { decodeBlocks: this.settings.blocks === 'decode' });
    const failure = new Promise((_, reject) => {
      object.addEventListener('error', ({ error }) => reject(error));
    });
    object.addEventListener('change', ({ urgent }) => {
      if (object.mesh.visible) this.plain.remove();
      // Draws may be slow: more of them would hold up what they wait for.
      if (urgent) this.stage.invalidate();
      else this.stage.invalidateSoon();
    });
    this.object = object;
    this.stage.scene.add(object);
    this.stage.look(boundsOf(field.vertices));
    this.panel.setModel(field.terms);
    this.want({ terms: this.settings.terms ?? field.terms });
    await Promise.race([object.load(source), failure]);
    await nextPicture();
    this.times.allShown = performance.now();
  }

  /** The mean view as other viewers show it: in a file it stands before the tables. */
  showPlainMesh(source) {
    this.plain.load(source).then((bounds) => {
      if (this.object?.mesh.visible) return;
      this.stage.scene.add(this.plain.object);
      this.stage.look(bounds);
    }).catch(() => {}); // the light field's own reader says what is wrong
  }

  want(change) {
    Object.assign(this.wanted, change);
    if (this.object === null) return;
    const { terms } = this.object.field;
    this.wanted.terms = Math.max(0, Math.min(Math.round(this.wanted.terms), terms));
    this.object.terms = this.wanted.meanOnly ? 0 : this.wanted.terms;
    this.panel.setTerms(this.wanted.terms, this.wanted.meanOnly);
    this.stage.invalidate();
  }

  /** Everything as `settings` (view_settings.js) say. */
  set(settings) {
    Object.assign(this.settings, { width: undefined, height: undefined }, settings);
    this.applyLook();
    this.stage.home();
    this.stage.resize();
    if (settings.terms !== undefined) this.want({ terms: settings.terms, meanOnly: false });
  }

  applyLook() {
    document.documentElement.style.setProperty('--background', `#${this.settings.background}`);
    this.stage.applyBackground();
    this.panel.setShown(this.settings.panel !== '0');
  }

  noteBytes(share) {
    if (this.error !== null) return;
    this.bytesShare = share;
    this.showProgress();
  }

  showProgress() {
    const terms = this.object === null ? 1 : this.object.field.terms + 1;
    const drawn = this.object === null ? 0 : this.object.loadedTerms + 1;
    this.panel.setProgress(0.5 * this.bytesShare + 0.5 * drawn / terms, Math.max(0, drawn - 1));
  }

  noteDrawn() {
    if (this.error !== null) return;
    this.showProgress();
    const shown = this.object?.loadedTerms >= 0 || this.plain.object.parent !== null;
    if (!shown || this.times.meanShown !== undefined) return;
    this.times.meanShown = performance.now();
    nextPicture().then(() => {
      this.times.meanShown = performance.now();
    });
  }

  /** Says on the page, in one line, what is wrong. */
  fail(error) {
    if (this.error !== null) return; // the first says what is wrong; others follow from it
    this.error = error instanceof ModelError ? error.message
      : `this page could not show its model (${error?.message ?? error})`;
    this.panel.fail(this.error);
  }

  state() {
    const { view } = this.stage;
    return {
      error: this.error,
      loadedTerms: this.object?.loadedTerms ?? -1,
      shownTerms: this.object?.shownTerms ?? 0,
      terms: this.wanted.terms,
      meanOnly: this.wanted.meanOnly,
      azimuth: view === null ? null : view.azimuth / kDegree,
      elevation: view === null ? null : view.elevation / kDegree,
      distance: view === null ? null : view.distance,
      target: view === null ? null : view.target,
      draws: this.stage.draws,
      coarse: this.stage.coarse,
      times: { ...this.times },
    };
  }
}

/** After what was drawn last has gone to the screen. */
function nextPicture() {
  return new Promise((resolve) => {
    requestAnimationFrame(() => setTimeout(resolve));
  });
}

function start() {
  const panel = new Panel();
  let app = null;
  const fail = (error) => {
    if (app !== null) app.fail(error);
    else panel.fail(error.message);
  };
  window.addEventListener('error', (event) => fail(event.error ?? event));
  window.addEventListener('unhandledrejection', (event) => {
    event.preventDefault();
    fail(event.reason);
  });
  try {
    app = new App(panel);
  } catch (error) {
    panel.fail(error.message);
    window.lfm = { ready: Promise.resolve(), state: () => ({ error: error.message }) };
    return;
  }
  const ready = app.show().catch((error) => app.fail(error)).then(() => app.state());
  // For pages that drive this one; settings are those of the address.
  window.lfm = {
    ready,
    state: () => app.state(),
    set: (settings) => app.set(settings),
    picture: () => app.stage.picture(),
  };
}

start();
