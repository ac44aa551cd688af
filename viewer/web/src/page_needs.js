// SPDX-License-Identifier: BSD-3-Clause
// How large pages must be to hold what the tables name. Texture arrays are made that large, before
// any picture has arrived, and pictures that are smaller are refused.

const kMaxSide = 16384;

/**
 * {mean, surface, view}: lists as in page_lists.js of {width, height}, 0 x 0 where nothing of a
 * page is named.
 */
export function measureNeeds(doc, field) {
  const { pages } = field;
  const needs = {
    mean: emptyNeeds(pages.mean),
    surface: pages.surface.map(emptyNeeds),
    view: pages.view.map(emptyNeeds),
  };
  const triangleTerms = termsOfTriangles(field);
  for (let t = 0; t < field.triangleCount; ++t) {
    growByPatch(doc, needs.mean, field.placements[0], t);
    for (let k = 0; k < triangleTerms[t]; ++k) {
      growByPatch(doc, needs.surface[k], field.placements[field.codebooks ? k + 1 : 0], t);
    }
  }
  for (let v = 0; v < field.vertexCount; ++v) {
    for (let k = 0; k < field.vertexTerms[v]; ++k) {
      const map = field.viewMaps[k].subarray(4 * v, 4 * v + 4);
      grow(doc, needs.view[k], map[2], map[0] + map[3], map[1] + map[3],
           'a view tile does not lie inside its page');
    }
  }
  return needs;
}

function emptyNeeds(pages) {
  return pages.map(() => ({ width: 0, height: 0 }));
}

function termsOfTriangles(field) {
  const terms = new Uint8Array(field.triangleCount);
  for (let c = 0; c < field.triangles.length; ++c) {
    const t = Math.floor(c / 3);
    terms[t] = Math.max(terms[t], field.vertexTerms[field.triangles[c]]);
  }
  return terms;
}

// The patch with its completions beyond the hypotenuse: what is read.
function growByPatch(doc, needs, placements, triangle) {
  const page = placements[4 * triangle];
  const x = placements[4 * triangle + 1], y = placements[4 * triangle + 2];
  const shape = placements[4 * triangle + 3];
  const last = (shape >> 1) - 1, flipped = (shape & 1) !== 0;
  const problem = 'a patch does not lie inside its page';
  doc.require(last >= 1 && (!flipped || (x >= last && y >= last)), problem);
  grow(doc, needs, page, x + (flipped ? 0 : last) + 1, y + (flipped ? 0 : last) + 1, problem);
}

function grow(doc, needs, page, width, height, problem) {
  doc.require(page < needs.length && width <= kMaxSide && height <= kMaxSide, problem);
  const need = needs[page];
  if (width > need.width) need.width = width;
  if (height > need.height) need.height = height;
}
