// SPDX-License-Identifier: BSD-3-Clause
// The page: shows its models and lets them be turned.
import { findModels } from './model_bytes.js';
import { ModelError } from './model_error.js';
import { listenForOrbit } from './orbit_input.js';
import { messageOf, startPage, untilRead } from './page_start.js';
import { Panel } from './panel.js';
import { ShownScene } from './shown_scene.js';
import { Stage } from './stage.js';
import { readSettings } from './view_settings.js';

const kDegree = Math.PI / 180;

class App {
  constructor(panel) {
    this.panel = panel;
    this.settings = readSettings(window.location.hash);
    this.models = null; // ShownScene, once it is known what is to be shown
    this.wanted = { terms: this.settings.terms ?? Infinity, meanOnly: false };
    this.times = {}; // ms since the page was asked for
    this.error = null; // what the page says
    this.broken = false; // nothing more is to come
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
    await untilRead(); // what needs no model is done by now
    this.times.pageRead = performance.now();
    this.models = new ShownScene(this.stage.scene, await findModels(),
                                 { decodeBlocks: this.settings.blocks === 'decode' });
    this.listenToModels();
    await this.models.load();
    await nextPicture();
    if (!this.broken) this.times.allShown = performance.now();
  }

  listenToModels() {
    const { models } = this;
    models.addEventListener('progress', () => this.showProgress());
    models.addEventListener('change', ({ urgent }) => {
      // Draws may be slow: more of them would hold up what they wait for.
      if (urgent) this.stage.invalidate();
      else this.stage.invalidateSoon();
    });
    models.addEventListener('bounds', () => {
      if (models.bounds !== null) this.stage.look(models.bounds);
    });
    models.addEventListener('tables', () => {
      this.panel.setModel(models.terms);
      this.want({});
    });
    models.addEventListener('failure', () => this.noteFailures());
  }

  want(change) {
    Object.assign(this.wanted, change);
    this.wanted.terms = Math.max(0, Math.round(this.wanted.terms));
    if (this.models === null) return;
    this.models.showTerms(this.wanted.meanOnly ? 0 : this.wanted.terms);
    this.panel.setTerms(this.terms, this.wanted.meanOnly);
    this.stage.invalidate();
  }

  /** How many terms are wanted, of those that there are. */
  get terms() {
    return Math.min(this.wanted.terms, this.models?.terms ?? Infinity);
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

  showProgress() {
    if (this.broken || this.models === null) return;
    this.panel.setProgress(this.models.share, Math.max(0, this.models.loadedTerms));
  }

  noteDrawn() {
    this.showProgress();
    if (this.broken || !this.models?.shown || this.times.meanShown !== undefined) return;
    this.times.meanShown = performance.now();
    nextPicture().then(() => {
      this.times.meanShown = performance.now();
    });
  }

  /** A model cannot be shown: its file is named, and the others stay. */
  noteFailures() {
    if (this.broken) return;
    const { failures, models } = this.models;
    if (failures.length === models.length) {
      this.fail(failures[0]);
      return;
    }
    const more = failures.length > 1 ? `; and ${failures.length - 1} more` : '';
    this.error = `${messageOf(failures[0])}${more}`;
    this.panel.warn(this.error);
    this.stage.invalidate();
  }

  /** Says on the page, in one line, what is wrong. */
  fail(error) {
    if (this.broken) return; // the first says what is wrong; others follow from it
    this.broken = true;
    this.error = messageOf(error);
    this.panel.fail(this.error);
  }

  state() {
    const { view } = this.stage;
    return {
      error: this.error,
      loadedTerms: this.models?.loadedTerms ?? -1,
      shownTerms: this.models?.shownTerms ?? 0,
      terms: this.terms,
      meanOnly: this.wanted.meanOnly,
      azimuth: view === null ? null : view.azimuth / kDegree,
      elevation: view === null ? null : view.elevation / kDegree,
      distance: view === null ? null : view.distance,
      target: view === null ? null : view.target,
      draws: this.stage.draws,
      coarse: this.stage.coarse,
      times: { ...this.times, ...this.models?.times },
    };
  }
}

/** After what was drawn last has gone to the screen. */
function nextPicture() {
  return new Promise((resolve) => {
    requestAnimationFrame(() => setTimeout(resolve));
  });
}

const panel = new Panel();
startPage(panel, () => new App(panel), (app) => ({
  picture: () => app.stage.picture(),
  measureFrames: (count) => app.stage.measureFrames(count),
}));
