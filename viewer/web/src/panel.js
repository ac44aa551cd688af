// SPDX-License-Identifier: BSD-3-Clause
// The controls on the page and what it says.
import { element, PagePanel } from './page_panel.js';

export class Panel extends PagePanel {
  constructor() {
    super();
    this.terms = 0;
    this.loaded = 0;
  }

  listen({ setTerms, toggleMean, home }) {
    const slider = element('terms');
    slider.addEventListener('input', () => setTerms(Number(slider.value)));
    element('mean').addEventListener('click', toggleMean);
    element('home').addEventListener('click', home);
    this.listenToKeys({
      m: toggleMean,
      r: home,
      ']': () => setTerms(Number(slider.value) + 1),
      '[': () => setTerms(Number(slider.value) - 1),
    });
  }

  setModel(terms) {
    this.terms = terms;
    element('terms').max = terms;
    this.showControls();
  }

  setTerms(terms, meanOnly) {
    const slider = element('terms');
    slider.value = terms;
    slider.disabled = this.terms === 0;
    element('mean').setAttribute('aria-pressed', String(meanOnly));
    this.shown = meanOnly ? 'mean view' : `${terms} of ${this.terms}`;
    slider.setAttribute('aria-valuetext', this.shown);
    this.describe();
  }

  /** `share`: of all work, 0 to 1. */
  setProgress(share, loadedTerms) {
    super.setProgress(share);
    this.loaded = loadedTerms;
    this.describe();
  }

  describe() {
    const loading = this.loaded < this.terms ? `, ${this.loaded} loaded` : '';
    element('count').textContent = `${this.shown ?? ''}${loading}`;
  }
}
