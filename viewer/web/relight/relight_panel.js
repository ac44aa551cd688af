// SPDX-License-Identifier: BSD-3-Clause
// The controls of the page for relighting, and its readings.
import { element, PagePanel } from '../src/page_panel.js';
import { madeTitles } from './made_surroundings.js';

const kOwn = 'own';

export class RelightPanel extends PagePanel {
  constructor() {
    super();
    for (const [name, title] of Object.entries(madeTitles)) addOption(name, title);
  }

  listen({ setAround, setTurn, setResiduals, setExposure, take, home }) {
    const onInput = (id, act) => {
      element(id).addEventListener('input', () => act(Number(element(id).value)));
    };
    onInput('turn', setTurn);
    onInput('residuals', setResiduals);
    onInput('exposure', setExposure);
    element('around').addEventListener('change', () => setAround(element('around').value));
    element('file').addEventListener('change', () => {
      const [file] = element('file').files;
      if (file !== undefined) take(file);
      element('file').value = ''; // the same one may be taken again
    });
    element('home').addEventListener('click', home);
    this.listenToKeys({
      r: home,
      ']': () => setResiduals(Number(element('residuals').value) + 1),
      '[': () => setResiduals(Number(element('residuals').value) - 1),
    });
  }

  setModel({ mostResiduals }) {
    element('residuals').max = mostResiduals;
    element('residuals').disabled = mostResiduals === 0;
    this.showControls();
  }

  /** Surroundings that the user has brought. */
  setOwn(title) {
    const option = [...element('around').options].find(({ value }) => value === kOwn);
    if (option === undefined) addOption(kOwn, title);
    else option.textContent = title;
  }

  /**
   * `around`: name of surroundings, '' for one light; `angles`: of the light, degrees to the right
   * and up; `milliseconds`: of a draw, 0 while that is not known.
   */
  show({ around, angles, turn, residuals, mostResiduals, exposure, milliseconds }) {
    element('around').value = around;
    element('turning').classList.toggle('hidden-dial', around === '');
    set('turn', turn, degrees(turn));
    set('residuals', residuals, `${residuals} of ${mostResiduals}`);
    const stops = `${exposure > 0 ? '+' : ''}${exposure.toFixed(1)}`.replace('-', '\u2212');
    set('exposure', exposure, `${stops} EV`);
    const hint = around === '' ? 'Drag on the picture to move the light'
      : 'Drag on the picture to turn its surroundings';
    element('hint').textContent = hint;
    const [right, up] = angles;
    const where = around !== '' ? '' : [side(right, 'right', 'left'), side(up, 'up', 'down')].join(', ');
    const time = milliseconds === 0 ? '' : `${milliseconds.toFixed(milliseconds < 10 ? 1 : 0)} ms a frame`;
    element('reading').textContent = [where, time].filter((text) => text !== '').join(' \u00b7 ');
  }

  /** What was said is over. */
  unsay() {
    element('error').hidden = true;
  }
}

function addOption(value, title) {
  element('around').append(new Option(title, value));
}

function set(id, value, text) {
  element(id).value = value;
  element(id).setAttribute('aria-valuetext', text);
  document.querySelector(`output[for=${id}]`).textContent = text;
}

const degrees = (angle) => `${Math.round(angle)}\u00b0`.replace('-', '\u2212');
const side = (angle, positive, negative) =>
  `${Math.abs(Math.round(angle))}\u00b0 ${angle >= 0 ? positive : negative}`;
