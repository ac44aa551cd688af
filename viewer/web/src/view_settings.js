// SPDX-License-Identifier: BSD-3-Clause
// What the address says after '#': how lfm-render's options are named there.

const kNumbers = {
  azimuth: [-3600, 3600], // degrees
  elevation: [-89, 89], // degrees
  distance: [0, 1e9], // mm; 0 fits the object in
  fov: [1, 150], // degrees
  terms: [0, 1024],
  width: [1, 16384], // pixels; the window's size when absent
  height: [1, 16384],
};
const kFlags = {
  panel: '1', // 0: the picture alone
  antialias: '1',
  blocks: 'device', // decode: as if the device read no compressed textures
};

const kDefaults = {
  azimuth: 300, elevation: 25, distance: 0, fov: 30, background: '181a1f',
};

/** The settings in `hash` ('#azimuth=30&terms=2'); what makes no sense is left out. */
export function readSettings(hash) {
  const settings = {};
  for (const [key, text] of new URLSearchParams(hash.replace(/^#/, ''))) {
    const limits = Object.hasOwn(kNumbers, key) ? kNumbers[key] : null;
    const value = Number(text);
    if (limits !== null && text !== '' && value >= limits[0] && value <= limits[1]) {
      settings[key] = value;
    }
    if (key === 'background' && /^#?[0-9a-f]{6}$/i.test(text)) {
      settings.background = text.replace('#', '').toLowerCase();
    }
    if (Object.hasOwn(kFlags, key)) settings[key] = text;
  }
  return { ...kDefaults, ...kFlags, ...settings };
}
