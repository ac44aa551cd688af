// SPDX-License-Identifier: BSD-3-Clause
// Mouse, touch and keyboard -> where light comes from.
import { isTyping } from '../src/orbit_input.js';

const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * Calls `move({x, y}, {dx})` while a pointer is down on `element`: x to the right and y upwards from
 * the middle, 1 at the nearer edge; dx since the last call, of the width. `shy`: the page is part of
 * another one, which goes on scrolling by vertical swipes.
 */
export function listenForDrags(element, shy, move) {
  element.style.touchAction = shy ? 'pan-y' : 'none';
  let active = null, before = 0;
  const tell = (event) => {
    const box = element.getBoundingClientRect();
    const half = Math.min(box.width, box.height) / 2;
    const x = event.clientX - box.left - box.width / 2, y = box.height / 2 + box.top - event.clientY;
    move({ x: x / half, y: y / half }, { dx: (event.clientX - before) / box.width });
    before = event.clientX;
  };
  element.addEventListener('pointerdown', (event) => {
    if (active !== null || event.button !== 0) return;
    active = event.pointerId;
    before = event.clientX;
    element.setPointerCapture(active);
    tell(event);
  });
  element.addEventListener('pointermove', (event) => {
    if (event.pointerId === active) tell(event);
  });
  for (const type of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    element.addEventListener(type, (event) => {
      if (event.pointerId === active) active = null;
    });
  }
  element.addEventListener('contextmenu', (event) => event.preventDefault());
}

/** `step(x, y)` for arrow keys, `home()` for Home, of the whole window. */
export function listenForArrows({ step, home }) {
  window.addEventListener('keydown', (event) => {
    if (isTyping(event)) return;
    if (event.key === 'Home') home();
    else if (Object.hasOwn(kArrows, event.key)) step(...kArrows[event.key]);
    else return;
    event.preventDefault();
  });
}

/** `take(file)` for a file dropped anywhere on the page. */
export function listenForDrops(take) {
  window.addEventListener('dragover', (event) => event.preventDefault());
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    const [file] = event.dataTransfer?.files ?? [];
    if (file !== undefined) take(file);
  });
}
