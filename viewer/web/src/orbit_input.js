// SPDX-License-Identifier: BSD-3-Clause
// Mouse, touch and keyboard -> changes of the camera.
import { orbit, pan, zoom } from './orbit_camera.js';

const kZoomPerWheelStep = 0.9;
const kPixelsPerWheelStep = 100;
const kLinesPerWheelStep = 3;
const kKeyTurn = 5 * Math.PI / 180;
const kKeyPan = 20; // pixels
const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * Listens to `element`, and to keys of the window. `change(edit)` is called with functions from
 * camera to camera, `focus(x, y)` on a double click, `home()` on the Home key. `shy`: the page is
 * part of another one, which goes on scrolling: by wheel until this one was clicked, and by
 * vertical swipes.
 */
export function listenForOrbit(element, { change, focus, home, shy }) {
  element.style.touchAction = shy ? 'pan-y' : 'none';
  listenToPointers(element, change);
  element.addEventListener('wheel', (event) => {
    if (shy && !document.hasFocus()) return;
    event.preventDefault();
    change((camera) => zoom(camera, kZoomPerWheelStep ** -wheelSteps(event)));
  }, { passive: false });
  element.addEventListener('dblclick', (event) => focus(event.offsetX, event.offsetY));
  element.addEventListener('contextmenu', (event) => event.preventDefault());
  window.addEventListener('keydown', (event) => {
    const edit = event.key === 'Home' ? home : editOfKey(event, element.clientHeight);
    if (edit === null || isTyping(event)) return;
    event.preventDefault();
    if (edit === home) home();
    else change(edit);
  });
}

function wheelSteps(event) {
  const { deltaY, deltaMode } = event;
  if (deltaMode === 1) return deltaY / kLinesPerWheelStep;
  return deltaMode === 2 ? deltaY : deltaY / kPixelsPerWheelStep;
}

/** Whether keys belong to a control, or to the browser. */
export function isTyping(event) {
  return event.altKey || event.ctrlKey || event.metaKey ||
    (event.target instanceof Element && event.target.matches('input, select, textarea'));
}

function editOfKey({ key, shiftKey }, height) {
  if (Object.hasOwn(kArrows, key)) {
    const [x, y] = kArrows[key];
    if (shiftKey) return (camera) => pan(camera, kKeyPan * x, -kKeyPan * y, height);
    return (camera) => orbit(camera, kKeyTurn * x, kKeyTurn * y);
  }
  if (key === '+' || key === '=') return (camera) => zoom(camera, kZoomPerWheelStep);
  if (key === '-' || key === '_') return (camera) => zoom(camera, 1 / kZoomPerWheelStep);
  return null;
}

// One pointer turns, with another button or Shift it moves; two zoom and move.
function listenToPointers(element, change) {
  const pointers = new Map();
  let moves = false;
  element.addEventListener('pointerdown', (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    moves = event.button !== 0 || event.shiftKey;
  });
  element.addEventListener('pointermove', (event) => {
    const before = pointers.get(event.pointerId);
    if (before === undefined) return;
    const now = { x: event.clientX, y: event.clientY };
    const height = element.clientHeight;
    if (pointers.size === 1) {
      const x = now.x - before.x, y = now.y - before.y;
      if (moves) change((camera) => pan(camera, x, y, height));
      else change((camera) => orbit(camera, -x * Math.PI / height, y * Math.PI / height));
    } else if (pointers.size === 2) {
      const [other] = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
      const distance = (at) => Math.max(1, Math.hypot(at.x - other.x, at.y - other.y));
      const factor = distance(before) / distance(now);
      const x = (now.x - before.x) / 2, y = (now.y - before.y) / 2;
      change((camera) => pan(zoom(camera, factor), x, y, height));
    }
    pointers.set(event.pointerId, now);
  });
  for (const type of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    element.addEventListener(type, (event) => pointers.delete(event.pointerId));
  }
}
