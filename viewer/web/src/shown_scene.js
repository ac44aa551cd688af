// SPDX-License-Identifier: BSD-3-Clause
// The models of a page: loads them together, and what they are as a whole.
import { boundsTogether } from './bounds.js';
import { ModelError } from './model_error.js';
import { ShownModel } from './shown_model.js';
import { UploadQueue } from './upload_queue.js';

/**
 * Loads all models into a three.js scene: the mean view of each as it arrives, then the first term
 * of each, the second of each, and so on. One that fails is left out; the others go on. Events:
 *
 *   progress  bytes arrived
 *   change    another draw would show more ({urgent}, as of LightFieldObject)
 *   bounds    there is more to look at
 *   tables    the number of terms may have grown
 *   failure   a model failed; see `failures`
 */
export class ShownScene extends EventTarget {
  /** `models`: of findModels (model_bytes.js). */
  constructor(scene, models, { decodeBlocks = false } = {}) {
    super();
    this.scene = scene;
    this.uploads = new UploadQueue();
    const options = { uploads: this.uploads, decodeBlocks };
    this.models = models.map((model) => new ShownModel(model, options));
    this.failures = []; // errors, one a model that failed, in the order in which they came
    this.times = {}; // ms since the page was asked for
    this.wantedTerms = Infinity;
  }

  /** Resolves when all that can be shown has been drawn with. */
  async load() {
    await Promise.all(this.models.map((model) => this.attempt(model, () => this.begin(model))));
    for (let k = 0; k < this.terms; ++k) {
      for (const model of this.models.filter(({ terms }) => k < terms)) {
        await this.attempt(model, () => model.object.loadTerm(model.source, k));
        await this.uploads.until(() => !this.uploads.full);
      }
    }
    for (const model of this.models) model.source = null; // as large as the file
    await this.uploads.until(() => this.models.every(
      ({ error, loadedTerms, terms }) => error !== null || loadedTerms >= terms));
  }

  // Up to the mean view.
  async begin(model) {
    await model.open(() => this.tell('progress'));
    this.noteTime('modelOpen', this.models.every(({ source, error }) => source ?? error));
    if (!model.source.whole) {
      // The light field's own reader says what is wrong.
      model.showPlain(this.scene).then(() => this.tell('bounds')).catch(() => {});
    }
    await model.readTables(this.scene);
    this.noteTime('tablesRead', this.working.every(({ object }) => object !== null));
    this.listen(model);
    model.object.terms = this.wantedTerms;
    this.tell('tables');
    this.tell('bounds');
    await model.object.loadMean(model.source);
  }

  listen(model) {
    model.object.addEventListener('error', ({ error }) => this.fail(model, error));
    model.object.addEventListener('change', ({ urgent }) => {
      if (model.drawn) model.plain.remove();
      this.tell('change', { urgent });
    });
  }

  async attempt(model, work) {
    try {
      if (model.error === null) await work();
    } catch (error) {
      this.fail(model, error);
    }
  }

  fail(model, error) {
    if (model.error !== null) return; // the first says what is wrong; others follow from it
    const unforeseen = !(error instanceof ModelError) && this.models.length > 1;
    const named = unforeseen
      ? new ModelError(`${model.name}: this page could not show it (${error.message})`) : error;
    model.fail(named);
    this.failures.push(named);
    this.tell('failure');
    this.tell('bounds');
    this.uploads.wake();
  }

  tell(type, properties = {}) {
    this.dispatchEvent(Object.assign(new Event(type), properties));
  }

  noteTime(what, reached) {
    if (reached) this.times[what] ??= performance.now();
  }

  /** Those that did not fail; all when none is left. */
  get working() {
    const working = this.models.filter(({ error }) => error === null);
    return working.length > 0 ? working : this.models;
  }

  /** The bounds (bounds.js) of what there is to look at, or null. */
  get bounds() {
    const parts = this.models.flatMap((model) => model.parts);
    return parts.length > 0 ? boundsTogether(parts) : null;
  }

  /** The most terms that a model has. */
  get terms() {
    return Math.max(...this.models.map(({ terms }) => terms));
  }

  /** Shows this many terms of each model, as far as it has them. */
  showTerms(terms) {
    this.wantedTerms = terms;
    for (const { object } of this.models) {
      if (object !== null) object.terms = terms;
    }
  }

  /** How many terms can be drawn of every model that has them; -1 before all mean views. */
  get loadedTerms() {
    const least = ({ loadedTerms, terms, object }) =>
      (object !== null && loadedTerms >= terms ? this.terms : loadedTerms);
    return Math.min(...this.working.map(least));
  }

  /** The most terms that a draw shows of a model now. */
  get shownTerms() {
    return Math.max(...this.models.map(({ object }) => object?.shownTerms ?? 0));
  }

  /** Whether the mean view, or more, of every model is on the screen. */
  get shown() {
    return this.working.every(({ shown }) => shown);
  }

  /** How much of all work is done, 0 to 1: half of it are bytes, half draws. */
  get share() {
    let bytes = 0, drawn = 0, all = 0;
    for (const { error, bytesShare, loadedTerms, terms } of this.models) {
      const failed = error !== null;
      bytes += failed ? 1 : bytesShare;
      drawn += failed ? terms + 1 : loadedTerms + 1;
      all += terms + 1;
    }
    return 0.5 * bytes / this.models.length + 0.5 * drawn / all;
  }
}
