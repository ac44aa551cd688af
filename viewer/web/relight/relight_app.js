// SPDX-License-Identifier: BSD-3-Clause
// The page for relighting: shows its picture under light that is moved by hand, or surroundings.
import { ModelError } from '../src/model_error.js';
import { messageOf, startPage, untilRead } from '../src/page_start.js';
import { prepareLight } from './evaluation.js';
import { gainFor } from './exposure.js';
import { kViews, parseRelightable } from './lfr_file.js';
import { LightBall } from './light_ball.js';
import { listenForArrows, listenForDrags, listenForDrops } from './light_input.js';
import { madeTitles, makeSurroundings } from './made_surroundings.js';
import { ModelLight } from './model_light.js';
import { loadModel } from './model_source.js';
import { RelightPanel } from './relight_panel.js';
import { RelitPicture } from './relit_picture.js';
import { readSettings } from './settings.js';
import { readMap } from './surroundings.js';
import {
  anglesOf, directionAt, turned, turnOfWorld, uprightFrameOf, viewFrameOf,
} from './view_frame.js';

const kFirstPlace = [-0.35, 0.35]; // of the light, in the picture
const kStep = 5; // degrees
const kTurnPerWidth = 180; // degrees
const kMostFileBytes = 2 ** 29;
const kTurns = [0, 90, 180, 270]; // that surroundings are looked at for their exposure
const kPlaces = [[0, 0], [-0.5, 0], [0.5, 0], [0, 0.5]]; // and the light

class RelightApp {
  constructor(panel) {
    this.panel = panel;
    this.canvas = document.getElementById('picture');
    this.settings = readSettings(window.location.hash);
    this.frame = viewFrameOf(document.querySelector('meta[name=camera]')?.content);
    this.upright = uprightFrameOf(this.frame);
    this.model = this.light = this.ball = null;
    this.maps = {}; // surroundings by name
    this.gains = {}; // by name of surroundings, '' for one light
    this.vector = null; // light from outside, in place of what the controls say
    this.error = null; // what the page says
    this.broken = false; // nothing more is to come
    this.picture = new RelitPicture(this.canvas, () => this.showPanel());
    this.applyLook();
    this.listen();
  }

  listen() {
    const { panel, canvas } = this, shy = window.parent !== window;
    panel.listen({
      setAround: (around) => this.set({ around }),
      setTurn: (turn) => this.set({ turn }),
      setResiduals: (residuals) => this.set({ residuals }),
      setExposure: (exposure) => this.set({ exposure, gain: undefined }),
      take: (file) => this.takeFile(file),
      home: () => this.home(),
    });
    listenForDrags(canvas, shy, ({ x, y }, { dx }) =>
      this.drag(directionAt(this.frame, x, y), dx * kTurnPerWidth));
    listenForDrags(document.getElementById('ball'), false, ({ x, y }, { dx }) => {
      if (this.ball !== null) this.drag(this.ball.directionAt(x, y), dx * kTurnPerWidth);
    });
    listenForArrows({ step: (x, y) => this.step(x, y), home: () => this.home() });
    listenForDrops((file) => this.takeFile(file));
    new ResizeObserver(() => this.fit()).observe(canvas.parentElement);
    canvas.addEventListener('webglcontextlost', () => {
      this.fail(new ModelError('the device took its graphics memory away; load the page again'));
    });
    canvas.addEventListener('webglcontextrestored', () => window.location.reload());
    window.addEventListener('hashchange', () => this.set(readSettings(window.location.hash)));
  }

  async show() {
    await untilRead();
    const { bytes, name } = await loadModel((share) => this.panel.setProgress(share));
    const model = parseRelightable(bytes, name);
    if (model.kind === kViews) {
      throw new ModelError(`${name}: shows one light from many sides; there is nothing to relight`);
    }
    if (model.width === 0) {
      throw new ModelError(`${name}: lights the vertices of a mesh; this page shows pictures only`);
    }
    this.light = new ModelLight(model, this.upright);
    this.picture.setModel(model);
    this.model = model;
    this.ball = new LightBall(document.getElementById('ball'), this.frame, this.upright,
                              model.directions);
    this.panel.setModel(model);
    this.panel.setProgress(1);
    this.set(this.settings);
    this.fit();
    await new Promise((resolve) => { requestAnimationFrame(() => setTimeout(resolve)); });
  }

  /** As `settings` (settings.js) say; what they leave out stays. */
  set(settings) {
    Object.assign(this.settings, settings);
    this.vector = null;
    this.applyLook();
    this.relight();
  }

  home() {
    this.settings = readSettings(window.location.hash);
    this.set({});
  }

  applyLook() {
    const { background, panel, slow } = this.settings;
    this.picture.slow = slow === '1';
    document.documentElement.style.setProperty('--background', `#${background}`);
    this.panel.setShown(panel !== '0');
  }

  /** The picture as large as its place allows, unstretched. */
  fit() {
    if (this.model === null) return;
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    const scale = Math.min(clientWidth / this.model.width, clientHeight / this.model.height);
    this.canvas.style.width = `${Math.max(1, Math.floor(scale * this.model.width))}px`;
    this.canvas.style.height = `${Math.max(1, Math.floor(scale * this.model.height))}px`;
  }

  /** Name of the surroundings; '' for one light. */
  get around() {
    const { around = '' } = this.settings;
    return Object.hasOwn(this.maps, around) || Object.hasOwn(madeTitles, around) ? around : '';
  }

  get direction() {
    return this.settings.light ?? directionAt(this.frame, ...kFirstPlace);
  }

  get residuals() {
    const most = this.model.mostResiduals;
    return Math.max(0, Math.min(most, Math.round(this.settings.residuals ?? most)));
  }

  get gain() {
    const { gain, exposure } = this.settings;
    return gain ?? this.chosenGain * 2 ** exposure;
  }

  /** For this kind of light; it does not change while that moves. */
  get chosenGain() {
    this.gains[this.around] ??= gainFor(this.model, this.around === ''
      ? kPlaces.map((place) => this.light.parallel(directionAt(this.frame, ...place)))
      : kTurns.map((turn) => this.light.surroundings(this.map, turn)));
    return this.gains[this.around];
  }

  get map() {
    return this.maps[this.around] ??= makeSurroundings(this.around);
  }

  /** Of the map, degrees. */
  get turn() {
    return this.settings.turn + (this.around === 'own' ? turnOfWorld(this.upright) : 0);
  }

  relight() {
    if (this.model === null || this.broken) return;
    const { around } = this;
    const light = this.vector ?? (around === '' ? this.light.parallel(this.direction)
      : this.light.surroundings(this.map, this.turn));
    this.picture.residuals = this.residuals;
    this.picture.setLight(prepareLight(this.model, light), this.gain);
    if (around === '') this.ball.showLight(this.direction);
    else this.ball.showSurroundings(this.map, this.turn);
    this.showPanel();
  }

  drag(direction, degrees) {
    this.panel.hideHint();
    if (this.around === '') this.set({ light: direction });
    else if (degrees !== 0) this.turnBy(degrees);
  }

  step(x, y) {
    if (this.model === null) return;
    if (this.around !== '') {
      this.turnBy(kStep * x);
      return;
    }
    const angle = kStep * Math.PI / 180;
    this.set({ light: turned(this.frame, this.direction, angle * x, angle * y) });
  }

  turnBy(degrees) {
    const turn = this.settings.turn + degrees;
    this.set({ turn: turn - 360 * Math.round(turn / 360) });
  }

  /** Light as a vector: numbers[channel][direction]. */
  setVector(numbers) {
    const { channels } = this.model, { count } = this.light;
    if (numbers.length !== channels || numbers.some((own) => own.length !== count)) {
      throw new RangeError(`light has ${channels} x ${count} numbers`);
    }
    this.vector = numbers.map((own) => Float64Array.from(own));
    this.relight();
  }

  /** Surroundings of the user's own. */
  async takeFile(file) {
    if (this.model === null || this.broken) return;
    try {
      if (file.size > kMostFileBytes) throw new ModelError(`${file.name}: larger than 512 MiB`);
      this.maps.own = readMap(new Uint8Array(await file.arrayBuffer()), file.name);
    } catch (error) {
      this.error = messageOf(error);
      this.panel.warn(this.error);
      return;
    }
    this.error = null;
    delete this.gains.own;
    this.panel.unsay();
    this.panel.setOwn(file.name);
    this.set({ around: 'own' });
  }

  showPanel() {
    if (this.model === null || this.broken) return;
    this.panel.show({
      around: this.around, angles: anglesOf(this.frame, this.direction), turn: this.settings.turn,
      residuals: this.residuals, mostResiduals: this.model.mostResiduals,
      exposure: this.settings.exposure, milliseconds: this.picture.drawMilliseconds,
    });
  }

  /** Says on the page, in one line, what is wrong. */
  fail(error) {
    if (this.broken) return; // the first says what is wrong; others follow from it
    this.broken = true;
    this.error = messageOf(error);
    this.panel.fail(this.error);
  }

  state() {
    const { model, picture } = this;
    const shown = model === null ? {} : {
      name: model.name, width: model.width, height: model.height, channels: model.channels,
      directions: this.light.count, residuals: this.residuals, mostResiduals: model.mostResiduals,
      around: this.around, light: this.direction, turn: this.settings.turn, gain: this.gain,
    };
    return { error: this.error, ...shown, draws: picture.draws, coarse: picture.coarse,
             drawMilliseconds: picture.drawMilliseconds };
  }
}

const panel = new RelightPanel();
startPage(panel, () => new RelightApp(panel), (app) => ({
  picture: () => app.picture.picture(),
  measureFrames: (count) => app.picture.measureFrames(count),
  light: (numbers) => app.setVector(numbers),
}));
