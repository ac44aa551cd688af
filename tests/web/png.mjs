// SPDX-License-Identifier: BSD-3-Clause
// 8-bit RGB and RGBA PNGs without packages, for comparing pictures.
import { inflateSync } from 'node:zlib';

/** {width, height, rgb: Uint8Array of 3 width height}. */
export function decodePng(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const width = view.getUint32(16), height = view.getUint32(20);
  const channels = { 2: 3, 6: 4 }[bytes[25]];
  if (bytes[24] !== 8 || channels === undefined || bytes[28] !== 0) throw new Error('other PNG');
  const parts = [];
  for (let at = 8; at < bytes.length;) {
    const length = view.getUint32(at);
    const type = String.fromCharCode(...bytes.subarray(at + 4, at + 8));
    if (type === 'IDAT') parts.push(bytes.subarray(at + 8, at + 8 + length));
    at += 12 + length;
  }
  const rows = inflateSync(Buffer.concat(parts));
  const stride = width * channels;
  const out = new Uint8Array(height * stride);
  for (let y = 0; y < height; ++y) {
    unfilter(rows, y * (stride + 1), out, y * stride, stride, channels, y > 0);
  }
  const rgb = new Uint8Array(3 * width * height);
  for (let i = 0; i < width * height; ++i) {
    for (let c = 0; c < 3; ++c) rgb[3 * i + c] = out[channels * i + c];
  }
  return { width, height, rgb };
}

function unfilter(rows, from, out, to, stride, channels, hasAbove) {
  const filter = rows[from];
  for (let x = 0; x < stride; ++x) {
    const left = x >= channels ? out[to + x - channels] : 0;
    const above = hasAbove ? out[to + x - stride] : 0;
    const corner = x >= channels && hasAbove ? out[to + x - stride - channels] : 0;
    const guess = [0, left, above, left + above >> 1, paeth(left, above, corner)][filter];
    out[to + x] = rows[from + 1 + x] + guess;
  }
}

function paeth(a, b, c) {
  const p = a + b - c;
  const pa = Math.abs(p - a), pb = Math.abs(p - b), pc = Math.abs(p - c);
  if (pa <= pb && pa <= pc) return a;
  return pb <= pc ? b : c;
}

/**
 * PSNR in dB over the pixels of `reference` that are not `background` (three numbers), the largest
 * difference there, and how many pixels differ outside.
 */
export function comparePictures(picture, reference, background) {
  if (picture.width !== reference.width || picture.height !== reference.height) {
    throw new Error(`${picture.width}x${picture.height} against ` +
                    `${reference.width}x${reference.height} pixels`);
  }
  let squares = 0, count = 0, largest = 0, outside = 0;
  for (let i = 0; i < reference.rgb.length; i += 3) {
    const isBackground = background.every((value, c) => reference.rgb[i + c] === value);
    const differences =
      background.map((_, c) => Math.abs(picture.rgb[i + c] - reference.rgb[i + c]));
    if (isBackground) {
      if (Math.max(...differences) > 0) ++outside;
      continue;
    }
    ++count;
    largest = Math.max(largest, ...differences);
    squares += differences.reduce((sum, d) => sum + d * d, 0);
  }
  return { psnr: 10 * Math.log10(255 ** 2 * 3 * count / squares), largest, outside, count };
}
