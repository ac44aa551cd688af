// SPDX-License-Identifier: BSD-3-Clause
// Pages as the buffer views hold them -> what a texture takes.
import { ModelError } from './model_error.js';

const kMaxSide = 16384;
const kPngSignature = [137, 80, 78, 71, 13, 10, 26, 10];

/** Size of an 8-bit RGB PNG, or null for anything else. */
export function readPngSize(bytes) {
  if (bytes.length < 33 || kPngSignature.some((byte, i) => bytes[i] !== byte)) return null;
  const view = new DataView(bytes.buffer, bytes.byteOffset, 33);
  const isHeader = view.getUint32(8) === 13 && view.getUint32(12) === 0x49484452;
  if (!isHeader || bytes[24] !== 8 || bytes[25] !== 2) return null;
  return { width: view.getUint32(16), height: view.getUint32(20) };
}

/** How many texels the pictures of a model may have together, as in C++; counted before decoding. */
export class TexelBudget {
  constructor(name) {
    this.name = name;
    this.left = 2 ** 28;
  }

  take(width, height) {
    this.left -= width * height;
    if (this.left >= 0) return;
    throw new ModelError(
      `${this.name}: the pages hold more texels than a model may have; run lfm-encode again`);
  }
}

/**
 * The page ready for its texture: {width, height, image} of a PNG (an ImageBitmap of the codes as
 * stored: no colour conversion), or {width, height, planes, blocks}. `need`: see page_needs.js.
 * `budget`: a TexelBudget.
 */
export async function decodePage(source, page, need, budget) {
  const fail = (problem) => {
    throw new ModelError(`${source.name}: ${problem}; run lfm-encode again`);
  };
  const bytes = await source.bufferView(page.bufferView);
  const size = page.planes === 0 ? readPngSize(bytes) : page;
  if (size === null) fail('an image is not an 8-bit RGB PNG');
  const { width, height } = size;
  if (Math.min(width, height) < 1 || Math.max(width, height) > kMaxSide) {
    fail('an image is larger than 16384 texels a side');
  }
  if (width < need.width || height < need.height) {
    fail('a patch or view tile does not lie inside its page');
  }
  if (page.planes > 0) {
    if (bytes.length !== page.planes * width * height / 2) {
      fail('the blocks of a page do not fill it');
    }
    return { width, height, planes: page.planes, blocks: bytes };
  }
  budget.take(width, height);
  const image = await decodePng(bytes).catch(() => fail('an image is damaged'));
  if (image.width !== width || image.height !== height) fail('an image differs from its header');
  return { width, height, image };
}

function decodePng(bytes) {
  return createImageBitmap(new Blob([bytes], { type: 'image/png' }),
                           { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
}
