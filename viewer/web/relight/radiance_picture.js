// SPDX-License-Identifier: BSD-3-Clause
// Radiance pictures (.hdr; G. Ward, "Real Pixels", Graphics Gems II), row by row: whatever size the
// file claims, one row is held.
import { ModelError } from '../src/model_error.js';

const kMostSide = 65536, kMostPixels = 2 ** 28;
const kMostRadiance = 1e30;

/**
 * Calls `take(y, row, {width, height})` for each row from the top; `row`: Float32Array of r, g, b
 * each, valid until the next. Returns {width, height}. Throws ModelError, `name` in front, for what is no whole
 * picture of this kind.
 */
export function readRadiancePicture(bytes, name, take) {
  const fail = (problem) => { throw new ModelError(`${name}: ${problem}`); };
  const { width, height, at } = readHeader(bytes, fail);
  const scanline = new Uint8Array(4 * width), row = new Float32Array(3 * width);
  let next = at;
  for (let y = 0; y < height; ++y) {
    next = readScanline(bytes, next, scanline, width, () => fail('cut short or damaged'));
    for (let x = 0; x < width; ++x) {
      const e = scanline[4 * x + 3];
      const unit = e === 0 ? 0 : 2 ** (e - 136);
      for (let c = 0; c < 3; ++c) row[3 * x + c] = Math.min(scanline[4 * x + c] * unit, kMostRadiance);
    }
    take(y, row, { width, height });
  }
  return { width, height };
}

function readHeader(bytes, fail) {
  let at = 0;
  const line = () => {
    const end = bytes.indexOf(10, at);
    if (end < 0 || end - at > 4096) fail('not a Radiance picture (.hdr)');
    const text = String.fromCharCode(...bytes.subarray(at, end)).replace(/\r$/, '');
    at = end + 1;
    return text;
  };
  if (!line().startsWith('#?')) fail('not a Radiance picture (.hdr)');
  for (let text = line(); text !== ''; text = line()) {
    const [key, value] = text.split('=');
    if (key === 'FORMAT' && value !== '32-bit_rle_rgbe') fail(`holds ${value}; save it as RGBE`);
  }
  const size = line().match(/^-Y (\d+) \+X (\d+)$/);
  if (size === null) fail('its rows do not run from the top left; save it again');
  const height = Number(size[1]), width = Number(size[2]);
  if (!(width >= 1 && height >= 1 && width <= kMostSide && height <= kMostSide)) {
    fail(`it is ${size[2]} x ${size[1]} pixels; a side has 1 to ${kMostSide}`);
  }
  if (width * height > kMostPixels) fail(`${width} x ${height} pixels are too many for a page`);
  return { width, height, at };
}

// Returns where the next one begins.
function readScanline(bytes, at, scanline, width, fail) {
  const isNew = width >= 8 && width < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 &&
    (bytes[at + 2] << 8 | bytes[at + 3]) === width;
  return isNew ? readPlanes(bytes, at + 4, scanline, width, fail)
    : readPixels(bytes, at, scanline, width, fail);
}

// Each of the four bytes by itself, in runs and stretches.
function readPlanes(bytes, from, scanline, width, fail) {
  let at = from;
  for (let c = 0; c < 4; ++c) {
    for (let x = 0; x < width;) {
      const count = bytes[at++], isRun = count > 128;
      const length = isRun ? count - 128 : count;
      if (!(length >= 1) || x + length > width || at + (isRun ? 1 : length) > bytes.length) fail();
      for (let i = 0; i < length; ++i, ++x) scanline[4 * x + c] = isRun ? bytes[at] : bytes[at++];
      if (isRun) ++at;
    }
  }
  return at;
}

// Whole pixels; 1, 1, 1, n repeats the one before n times, more digits of n follow.
function readPixels(bytes, from, scanline, width, fail) {
  let at = from, shift = 0;
  for (let x = 0; x < width; at += 4) {
    if (at + 4 > bytes.length) fail();
    if (bytes[at] !== 1 || bytes[at + 1] !== 1 || bytes[at + 2] !== 1) {
      scanline.set(bytes.subarray(at, at + 4), 4 * x++);
      shift = 0;
      continue;
    }
    const count = shift > 16 ? Infinity : bytes[at + 3] << shift;
    if (x === 0 || x + count > width) fail();
    for (let i = 0; i < count; ++i, ++x) scanline.copyWithin(4 * x, 4 * x - 4, 4 * x);
    shift += 8;
  }
  return at;
}
