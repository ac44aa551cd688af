// SPDX-License-Identifier: BSD-3-Clause
// The controls on the page and what it says.

const kHintSeconds = 8;

const element = (id) => document.getElementById(id);

export class Panel {
  constructor() {
    element('title').textContent = document.title;
    this.terms = 0;
    this.loaded = 0;
    const full = element('full');
    full.hidden = !document.fullscreenEnabled;
    full.addEventListener('click', toggleFullScreen);
    document.addEventListener('fullscreenchange', () => {
      full.setAttribute('aria-pressed', String(document.fullscreenElement !== null));
    });
  }

  listen({ setTerms, toggleMean, home }) {
    const slider = element('terms');
    slider.addEventListener('input', () => setTerms(Number(slider.value)));
    element('mean').addEventListener('click', toggleMean);
    element('home').addEventListener('click', home);
    const keys = {
      m: toggleMean,
      r: home,
      f: () => element('full').hidden || toggleFullScreen(),
      ']': () => setTerms(Number(slider.value) + 1),
      '[': () => setTerms(Number(slider.value) - 1),
    };
    window.addEventListener('keydown', (event) => {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const key = event.key.toLowerCase();
      if (Object.hasOwn(keys, key)) keys[key]();
    });
  }

  setShown(shown) {
    document.body.classList.toggle('bare', !shown);
  }

  setModel(terms) {
    this.terms = terms;
    element('terms').max = terms;
    element('controls').hidden = false;
    setTimeout(() => this.hideHint(), 1000 * kHintSeconds);
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
    const bar = element('progress');
    bar.value = share;
    bar.hidden = share >= 1;
    this.loaded = loadedTerms;
    this.describe();
  }

  describe() {
    const loading = this.loaded < this.terms ? `, ${this.loaded} loaded` : '';
    element('count').textContent = `${this.shown ?? ''}${loading}`;
  }

  hideHint() {
    element('hint').classList.add('gone');
  }

  fail(message) {
    this.say(message);
    element('progress').hidden = true;
    this.hideHint();
  }

  /** Beside what can be shown. */
  warn(message) {
    this.say(message);
    element('error').classList.add('aside');
  }

  say(message) {
    element('error').textContent = message;
    element('error').classList.remove('aside');
    element('error').hidden = false;
  }
}

function toggleFullScreen() {
  const done = document.fullscreenElement === null ? document.documentElement.requestFullscreen()
    : document.exitFullscreen();
  done?.catch(() => {}); // the browser may refuse, and then nothing changes
}
