// SPDX-License-Identifier: BSD-3-Clause
// What the address says after '#'.

const kNumbers = {
  turn: [-3600, 3600], // of surroundings, degrees
  residuals: [0, 65535],
  exposure: [-10, 10], // stops beyond what the page chooses
  gain: [1e-30, 1e30], // what linear radiance is multiplied with, in place of what the page chooses
};

/**
 * The settings in `hash` ('#light=0,0,1&residuals=4'); what makes no sense is left out. `light`: the
 * direction to a light, world frame; `around`: the name of surroundings; `panel`: '0' for the picture
 * alone; `slow`: '1' as if the device were slow; `background`: rrggbb.
 */
export function readSettings(hash) {
  const settings = {};
  for (const [key, text] of new URLSearchParams(hash.replace(/^#/, ''))) {
    const limits = Object.hasOwn(kNumbers, key) ? kNumbers[key] : null;
    const value = Number(text);
    if (limits !== null && text !== '' && value >= limits[0] && value <= limits[1]) {
      settings[key] = value;
    }
    if (key === 'light') {
      const numbers = text.split(',').map(Number), length = Math.hypot(...numbers);
      if (numbers.length === 3 && length > 1e-6 && length < 1e6) {
        settings.light = numbers.map((x) => x / length);
      }
    }
    if (['around', 'panel', 'slow'].includes(key)) settings[key] = text;
    if (key === 'background' && /^#?[0-9a-f]{6}$/i.test(text)) {
      settings.background = text.replace('#', '').toLowerCase();
    }
  }
  return { background: '181a1f', panel: '1', exposure: 0, turn: 0, ...settings };
}
