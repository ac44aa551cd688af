// SPDX-License-Identifier: BSD-3-Clause
// What every page has: its title, full screen, progress, a hint, and a line that says what is wrong.

const kHintSeconds = 8;

export const element = (id) => document.getElementById(id);

export class PagePanel {
  constructor() {
    element('title').textContent = document.title;
    const full = element('full');
    full.hidden = !document.fullscreenEnabled;
    full.addEventListener('click', toggleFullScreen);
    document.addEventListener('fullscreenchange', () => {
      full.setAttribute('aria-pressed', String(document.fullscreenElement !== null));
    });
  }

  /** `keys`: {key in lower case: what it does}. F is full screen. */
  listenToKeys(keys) {
    const all = { f: () => element('full').hidden || toggleFullScreen(), ...keys };
    window.addEventListener('keydown', (event) => {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const key = event.key.toLowerCase();
      if (Object.hasOwn(all, key)) all[key]();
    });
  }

  setShown(shown) {
    document.body.classList.toggle('bare', !shown);
  }

  /** There is something to control. */
  showControls() {
    element('controls').hidden = false;
    setTimeout(() => this.hideHint(), 1000 * kHintSeconds);
  }

  /** `share`: of all work, 0 to 1. */
  setProgress(share) {
    const bar = element('progress');
    bar.value = share;
    bar.hidden = share >= 1;
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
