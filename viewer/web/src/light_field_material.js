// SPDX-License-Identifier: BSD-3-Clause
// The desktop viewer's shaders (viewer/shaders) in GLSL ES 3.00.
import { DoubleSide, GLSL3, Matrix4, RawShaderMaterial, Vector3 } from 'three';
import fragmentShader from '../../shaders/light_field.frag.glsl';
import squareFromDirection from '../../shaders/square_from_direction.glsl';
import vertexShader from '../../shaders/light_field.vert.glsl';
import { kMostTerms } from './light_field.js';
import { makeTableTextures } from './table_textures.js';

const kPrecision = `precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
`;

// The maps hold sRGB-coded colours, as a canvas takes them. Render targets of three.js are linear.
const kOutput = `
uniform int linear_output;
void main() {
  DrawLightField();
  vec3 linear = mix(pow((color.rgb + 0.055) / 1.055, vec3(2.4)), color.rgb / 12.92,
                    vec3(lessThanEqual(color.rgb, vec3(0.04045))));
  if (linear_output != 0) color.rgb = linear;
}
`;

/** Desktop GLSL as RawShaderMaterial with GLSL3 takes it. */
export function shaderForBrowser(text) {
  return kPrecision + text.replace(/^#version.*\n/, '')
    .replace('//#include square_from_direction', () => squareFromDirection);
}

function fragmentForBrowser(text) {
  return shaderForBrowser(text).replace('void main()', 'void DrawLightField()') + kOutput;
}

const uniform = (value) => ({ value });

/**
 * Draws a light field with `maps` (map_textures.js). Uniforms `clip_from_model`, `eye` (relative
 * to the origin of the positions), `terms` and `linear_output` are set a draw.
 */
export function makeLightFieldMaterial(field, maps) {
  const tables = makeTableTextures(field);
  const firsts = (list) => uniform([...list, ...Array(kMostTerms).fill(0)].slice(0, kMostTerms));
  const material = new RawShaderMaterial({
    name: 'surface light field',
    glslVersion: GLSL3,
    vertexShader: shaderForBrowser(vertexShader),
    fragmentShader: fragmentForBrowser(fragmentShader),
    side: DoubleSide,
    toneMapped: false,
    uniforms: {
      mean_maps: uniform(maps.mean.texture),
      surface_maps: uniform(maps.surface.texture),
      view_maps: uniform(maps.view.texture),
      frames: uniform(tables.frames),
      ranges: uniform(tables.ranges),
      patches: uniform(tables.patches),
      tiles: uniform(tables.tiles),
      codebooks: uniform(1),
      blocks: uniform(field.pages.surfaceFormat === 'png' ? 0 : 1),
      surface_planes: uniform(1),
      triangle_count: uniform(field.triangleCount),
      terms: uniform(0),
      vertex_count: uniform(field.vertexCount),
      grid: uniform(field.grid),
      surface_first: firsts(maps.surfaceFirst),
      view_first: firsts(maps.viewFirst),
      view_tiles_per_row: uniform(field.viewTilesPerRow),
      view_tiles_per_page: uniform(field.viewTilesPerPage),
      direction_map: uniform(field.directionMap),
      view_coordinates_per_vertex: uniform(0),
      mean_in_terms: uniform(field.meanInTerms ? 1 : 0),
      wireframe: uniform(0),
      linear_output: uniform(0),
      clip_from_model: uniform(new Matrix4()),
      eye: uniform(new Vector3()),
    },
  });
  material.addEventListener('dispose', () => {
    for (const table of Object.values(tables)) table.dispose();
  });
  return material;
}
