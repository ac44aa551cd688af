// SPDX-License-Identifier: BSD-3-Clause
// Blocks of 4 x 4 texels as pictures, for devices that do not read them; integers as in
// docs/formats.md, "Blocks".

/** Writes the four colours of a BC1 block into `palette` (12 numbers). */
function readBc1Palette(bytes, at, palette) {
  const first = bytes[at] | bytes[at + 1] << 8;
  const second = bytes[at + 2] | bytes[at + 3] << 8;
  const packed = [first, second];
  for (let end = 0; end < 2; ++end) {
    const r = packed[end] >> 11 & 31, g = packed[end] >> 5 & 63, b = packed[end] & 31;
    palette[3 * end] = r << 3 | r >> 2;
    palette[3 * end + 1] = g << 2 | g >> 4;
    palette[3 * end + 2] = b << 3 | b >> 2;
  }
  for (let c = 0; c < 3; ++c) {
    const a = palette[c], b = palette[3 + c];
    palette[6 + c] = first > second ? a + (85 * (b - a) >> 8) : a + b + 1 >> 1;
    palette[9 + c] = first > second ? a + (85 * (b - a) >> 7) : 0;
  }
}

function readBc4Palette(first, second, palette) {
  palette[0] = first;
  palette[1] = second;
  const parts = first > second ? 7 : 5;
  const whole = Math.floor(255 * 64 / parts);
  for (let k = 1; k < parts; ++k) {
    palette[k + 1] = first + ((second - first) * (whole * k >> 6) >> 8);
  }
  if (parts === 5) {
    palette[6] = 0;
    palette[7] = 255;
  }
}

/** A page of BC1 blocks, row by row, as RGBA. `width`, `height`: multiples of 4. */
export function decodeBc1(bytes, width, height) {
  const texels = new Uint8Array(4 * width * height);
  const palette = new Int32Array(12);
  let at = 0;
  for (let y = 0; y < height; y += 4) {
    for (let x = 0; x < width; x += 4, at += 8) {
      readBc1Palette(bytes, at, palette);
      for (let row = 0; row < 4; ++row) {
        let bits = bytes[at + 4 + row];
        let to = 4 * ((y + row) * width + x);
        for (let column = 0; column < 4; ++column, bits >>= 2, to += 4) {
          const from = 3 * (bits & 3);
          texels[to] = palette[from];
          texels[to + 1] = palette[from + 1];
          texels[to + 2] = palette[from + 2];
          texels[to + 3] = 255;
        }
      }
    }
  }
  return texels;
}

/** Three planes of BC4 blocks, one after the other, as the R, G and B of RGBA. */
export function decodeBc4Planes(bytes, width, height) {
  const texels = new Uint8Array(4 * width * height).fill(255);
  const palette = new Int32Array(8);
  let at = 0;
  for (let plane = 0; plane < 3; ++plane) {
    for (let y = 0; y < height; y += 4) {
      for (let x = 0; x < width; x += 4, at += 8) {
        readBc4Palette(bytes[at], bytes[at + 1], palette);
        for (let half = 0; half < 2; ++half) {
          const from = at + 2 + 3 * half;
          let bits = bytes[from] | bytes[from + 1] << 8 | bytes[from + 2] << 16;
          for (let i = 0; i < 8; ++i, bits >>= 3) {
            const row = y + 2 * half + (i >> 2), column = x + (i & 3);
            texels[4 * (row * width + column) + plane] = palette[bits & 7];
          }
        }
      }
    }
  }
  return texels;
}
