// SPDX-License-Identifier: BSD-3-Clause
// Which buffer views hold the pages of a model, as PNG or in blocks.

const kMaxSide = 16384;
const kMaxTexels = 2 ** 28; // of all pages in blocks together
const kMostPages = 4096; // of a list; more than any device has layers

/**
 * {surfaceFormat, blocks, mean, surface, view}: `surfaceFormat` is 'png', 'bc1' or 'bc4'; `mean` a
 * list of pages, `surface` and `view` K lists. A page is {bufferView, planes}, in blocks with
 * {width, height}; planes: of blocks, 0 for a PNG.
 */
export function readPageLists(doc, extension, terms) {
  if ('blocks' in extension) return readBlockLists(doc, extension.blocks, terms);
  const page = (index) => {
    const image = doc.source.json.images?.[doc.index(index, 'an image index')];
    const { bufferView } = doc.object(image, 'an image');
    return { bufferView: doc.index(bufferView, 'the buffer view of an image'), planes: 0 };
  };
  const pages = (list, what) => {
    doc.list(list, what);
    doc.require(list.length <= kMostPages, `${what} holds too many pages`);
    return list.map(page);
  };
  const lists = (key) => {
    if (terms === 0 && extension[key] === undefined) return [];
    return doc.list(extension[key], `"${key}"`, terms).map((list) => pages(list, `"${key}"`));
  };
  return {
    surfaceFormat: 'png',
    mean: pages(extension.meanImages, '"meanImages"'),
    surface: lists('surfaceImages'),
    view: lists('viewImages'),
  };
}

function readBlockLists(doc, blocks, terms) {
  doc.object(blocks, '"blocks"');
  const format = blocks.surfaceFormat;
  doc.require(format === 'bc1' || format === 'bc4', '"surfaceFormat" is neither bc1 nor bc4');
  let texels = 0;
  const side = (value) => {
    doc.integer(value, 'the size of a page in blocks', 4, kMaxSide);
    doc.require(value % 4 === 0, 'the blocks of a page do not fill it');
    return value;
  };
  const pages = (list, planes) => {
    doc.list(list, 'a list of pages in blocks');
    doc.require(list.length <= kMostPages, 'a list holds too many pages in blocks');
    return list.map((entry) => {
      const { bufferView, width, height } = doc.object(entry, 'a page in blocks');
      texels += side(width) * side(height);
      doc.require(texels <= kMaxTexels, 'the pages hold more texels than a model may have');
      return { bufferView: doc.index(bufferView, 'a buffer view'), width, height, planes };
    });
  };
  const lists = (key, planes) =>
    doc.list(blocks[key], `"${key}"`, terms).map((list) => pages(list, planes));
  return {
    surfaceFormat: format,
    mean: pages(blocks.mean, 1),
    surface: lists('surface', format === 'bc1' ? 1 : 3),
    view: lists('view', 1),
  };
}
