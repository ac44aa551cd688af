#version 330 core
// SPDX-License-Identifier: BSD-3-Clause
// colour = mean + sum over terms k and corners j of surface map [k, j] times view map [k, j]
// (Chen 2002, Equations 3 and 6), on sRGB-coded values, in float, clamped once at the end.
//
// LFM_TERM k       term k alone, over gray or black
// LFM_TONE 0, 1    viewer/tone.h: clipped, soft
// LFM_PASS 0 to 2  a pass of the paper's algorithm: the mean view; the product of a surface and a
//                  view map, its part of one sign; the product of their parts of one sign each

#ifdef LFM_CORNER_TERMS
centroid in vec3 corner_views[3 * LFM_CORNER_TERMS];
centroid in vec3 corner_bias;
#else
centroid in vec3 view_vector[3];
flat in ivec3 view_tile[3];
#endif
centroid in vec3 corner_weights;
#ifndef LFM_CORNER_TERMS
flat in ivec3 patch_corners;
#endif
flat in int patch_triangle;  // its number
flat in ivec3 corner_terms;

uniform sampler2DArray mean_maps;
uniform sampler2DArray surface_maps;
uniform sampler2DArray view_maps;
uniform sampler2D ranges;
uniform sampler2D patches;  // where each triangle's mean view lies; with codebooks its terms', too
uniform sampler2D tiles;    // with codebooks: where each vertex's view maps lie, and their grid
#ifndef LFM_CONSTANTS  // else they are constants, which software runs several times as fast
uniform int codebooks;
uniform int blocks;          // pages are in blocks: completions beyond the hypotenuse are not exact
uniform int surface_planes;  // layers of a surface page: 1 (RGB), or one a corner
uniform int direction_map;
uniform int view_coordinates_per_vertex;
uniform int mean_in_terms;
uniform int wireframe;
#endif
uniform int triangle_count;
uniform int terms;
uniform int vertex_count;
uniform int grid;
uniform int surface_first[16];  // layer of each term's first page
uniform int view_first[16];
#ifdef LFM_TONE
uniform float exposure;  // a factor of linear light
#endif
#ifdef LFM_PASS
uniform int pass_term, pass_corner;
uniform vec2 pass_signs;  // which parts: of the surface map, of the view map
#endif

out vec4 color;

//#include square_from_direction

// Texel centres are integers here and halves in OpenGL.
vec3 ReadTexel(sampler2DArray maps, vec2 texel, int layer) {
  return textureLod(maps, vec3((texel + 0.5) / vec2(textureSize(maps, 0).xy), float(layer)), 0.0)
      .rgb;
}

// Tables are 1024 texels wide: software divides integers one by one.
vec4 Entry(sampler2D table, int entry) {
  return texelFetch(table, ivec2(entry & 1023, entry >> 10), 0);
}

// Where a patch lies: sample (0, 0), and one step of i and j.
struct Patch {
  vec2 origin;
  float step;  // -1 when flipped
  float last;  // n - 1
  int page;
};

// `layer` 0: the mean view; k + 1: term k.
Patch PatchOfTriangle(int layer) {
  vec4 entry = Entry(patches, layer * triangle_count + patch_triangle);
  return Patch(entry.xy, sign(entry.w), abs(entry.w), int(entry.z + 0.5));
}

// A texel of the page, or of its three planes.
vec3 ReadPlanes(sampler2DArray maps, vec2 texel, int layer, int planes) {
  if (planes == 1) return ReadTexel(maps, texel, layer);
  return vec3(ReadTexel(maps, texel, layer * 3).r, ReadTexel(maps, texel, layer * 3 + 1).r,
              ReadTexel(maps, texel, layer * 3 + 2).r);
}

vec3 FetchPlanes(sampler2DArray maps, vec2 texel, int layer, int planes) {
  ivec2 at = ivec2(texel + 0.5);
  if (planes == 1) return texelFetch(maps, ivec3(at, layer), 0).rgb;
  return vec3(texelFetch(maps, ivec3(at, layer * 3), 0).r,
              texelFetch(maps, ivec3(at, layer * 3 + 1), 0).r,
              texelFetch(maps, ivec3(at, layer * 3 + 2), 0).r);
}

// In a cell on the hypotenuse: the plane through its three samples, as the weighted mean of two
// readings along its legs, whatever stands beyond the hypotenuse.
vec3 ReadPatch(sampler2DArray maps, Patch place, vec2 weights, int layer, int planes) {
  vec2 grid_position = weights * place.last;
  if (blocks == 0) {
    return ReadPlanes(maps, place.origin + place.step * grid_position, layer, planes);
  }
  vec2 cell = min(floor(grid_position), vec2(place.last - 1.0));
  vec2 corner = place.origin + place.step * cell, inside = grid_position - cell;
  bool on_hypotenuse = cell.x + cell.y > place.last - 1.5;
  float last = on_hypotenuse ? 0.0 : inside.x * inside.y;
  return (1.0 - inside.x - inside.y + last) * FetchPlanes(maps, corner, layer, planes) +
         (inside.x - last) * FetchPlanes(maps, corner + vec2(place.step, 0.0), layer, planes) +
         (inside.y - last) * FetchPlanes(maps, corner + vec2(0.0, place.step), layer, planes) +
         last * FetchPlanes(maps, corner + place.step, layer, planes);
}

#ifndef LFM_CORNER_TERMS
float SurfaceFactor(int k, int j, float code) {
  vec4 range = Entry(ranges, k * vertex_count + patch_corners[j]);
  return range.x * code + range.y;
}

vec3 ViewFactor(int k, int j, vec2 square) {
  vec4 range = Entry(ranges, k * vertex_count + patch_corners[j]);
  ivec4 tile = ivec4(view_tile[j], grid);
  if (codebooks != 0) tile = ivec4(Entry(tiles, k * vertex_count + patch_corners[j]) + 0.5);
  vec3 view = ReadTexel(view_maps, vec2(tile.xy) + square * float(tile.w - 1),
                        view_first[k] + tile.z);
  return range.z * view + range.w;
}
#endif

vec3 SurfaceCodes(int k, Patch mean_place, vec2 weights) {
  Patch place = mean_place;
  if (codebooks != 0) place = PatchOfTriangle(k + 1);
  return ReadPatch(surface_maps, place, weights, surface_first[k] + place.page, surface_planes);
}

#ifdef LFM_TONE
vec3 ShowTone(vec3 coded) {
  coded = max(coded, 0.0);
  vec3 linear = exposure * mix(pow((coded + 0.055) / 1.055, vec3(2.4)), coded / 12.92,
                               vec3(lessThanEqual(coded, vec3(0.04045))));
#if LFM_TONE == 1
  vec3 rolled_off = 0.8 + 0.2 * (1.0 - exp((0.8 - linear) / 0.2));
  linear = mix(linear, rolled_off, vec3(greaterThan(linear, vec3(0.8))));
#endif
  return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
             vec3(lessThanEqual(linear, vec3(0.0031308))));
}
#endif

// 1 on the triangle's edges, falling to 0 within a pixel and a quarter.
float EdgeShare() {
  vec3 pixels = corner_weights / max(fwidth(corner_weights), vec3(1e-9));
  return 1.0 - smoothstep(0.25, 1.25, min(pixels.x, min(pixels.y, pixels.z)));
}

void main() {
#ifndef LFM_CORNER_TERMS
  vec2 view_square[3];
  for (int j = 0; j < 3; ++j) {
    vec2 square = view_coordinates_per_vertex != 0
                      ? view_vector[j].xy
                      : SquareFromDirection(normalize(view_vector[j]), direction_map);
    view_square[j] = clamp(square, 0.0, 1.0);
  }
#endif
  // Corners whose terms do not hold the mean view show it themselves.
  float mean_share = 1.0;
  if (mean_in_terms != 0 && terms > 0) {
    mean_share = 0.0;
    for (int j = 0; j < 3; ++j) {
      if (corner_terms[j] == 0) mean_share += corner_weights[j];
    }
  }
  vec2 weights = clamp(corner_weights.yz, 0.0, 1.0);
  weights.y = min(weights.y, 1.0 - weights.x);
  Patch place = PatchOfTriangle(0);
#if defined(LFM_PASS) && LFM_PASS != 0
  if (pass_term >= corner_terms[pass_corner]) discard;
  float g = SurfaceFactor(pass_term, pass_corner,
                          SurfaceCodes(pass_term, place, weights)[pass_corner]);
  vec3 h = ViewFactor(pass_term, pass_corner, view_square[pass_corner]);
#if LFM_PASS == 1
  vec3 sum = pass_signs.x * g * h;
#else
  vec3 sum = max(pass_signs.x * g, 0.0) * max(pass_signs.y * h, 0.0);
#endif
#else
#ifdef LFM_TERM
  vec3 sum = vec3(mean_in_terms != 0 ? 0.0 : 0.5);
#else
  vec3 sum = mean_share * ReadPatch(mean_maps, place, weights, place.page, 1);
#endif
#ifndef LFM_PASS
  int shown = min(terms, max(corner_terms[0], max(corner_terms[1], corner_terms[2])));
#if defined(LFM_TERM)
  for (int k = LFM_TERM; k < min(shown, LFM_TERM + 1); ++k) {
#elif defined(LFM_CORNER_TERMS)
  sum += corner_bias;
  for (int k = 0; k < LFM_CORNER_TERMS; ++k) {  // unrolled: corner_views is not indexed then
#else
  for (int k = 0; k < shown; ++k) {
#endif
    vec3 surface = SurfaceCodes(k, place, weights);
    for (int j = 0; j < 3; ++j) {
#ifdef LFM_CORNER_TERMS
      sum += surface[j] * corner_views[3 * k + j];
#else
      sum += SurfaceFactor(k, j, surface[j]) * ViewFactor(k, j, view_square[j]);
#endif
    }
  }
#endif
#endif
#ifdef LFM_TONE
  sum = ShowTone(sum);
#endif
  if (wireframe != 0) sum = mix(sum, vec3(0.15, 0.75, 1.0), 0.7 * EdgeShare());
  color = vec4(clamp(sum, 0.0, 1.0), 1.0);
}
