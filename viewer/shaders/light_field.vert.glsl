#version 330 core
// SPDX-License-Identifier: BSD-3-Clause
// One corner of a triangle: where it is, and the direction to the eye in the frames of all three
// corners. That vector, before it is normalised, is linear over the triangle: interpolating it and
// normalising a pixel is exact.

in vec3 position;  // mm, relative to the mesh's centre
in ivec3 corners;  // the triangle's vertices
in int triangle;

invariant gl_Position;  // the passes of one picture meet the same depths

uniform mat4 clip_from_model;
uniform vec3 eye;
uniform sampler2D frames;
uniform int grid;
uniform int view_tiles_per_row;
uniform int view_tiles_per_page;
#ifndef LFM_CONSTANTS
uniform int direction_map;
uniform int view_coordinates_per_vertex;
uniform int codebooks;
#endif

#ifdef LFM_CORNER_TERMS
// View maps are read here, at the triangle's corners, and interpolated over it.
uniform sampler2DArray view_maps;
uniform sampler2D ranges;
uniform sampler2D tiles;
uniform int terms;
uniform int vertex_count;
uniform int view_first[16];
// A term's product is (scale code + bias) view, of which code alone changes over the triangle:
centroid out vec3 corner_views[3 * LFM_CORNER_TERMS];  // scale view, of term k and corner j: 3 k + j
centroid out vec3 corner_bias;                         // bias view, summed
#endif

#ifndef LFM_CORNER_TERMS
centroid out vec3 view_vector[3];  // per pixel: towards the eye; per vertex: (square position, 0)
flat out ivec3 view_tile[3];       // x, y of the top-left texel, page
#endif
centroid out vec3 corner_weights;
#ifndef LFM_CORNER_TERMS
flat out ivec3 patch_corners;
#endif
flat out int patch_triangle;
flat out ivec3 corner_terms;

// xyz: an axis of the vertex's frame; w: of x the number of its view tile, of y its terms.
vec4 FrameEntry(int vertex, int axis) {
  int entry = 3 * vertex + axis;
  return texelFetch(frames, ivec2(entry & 1023, entry >> 10), 0);
}

//#include square_from_direction

#ifdef LFM_CORNER_TERMS
vec4 VertexEntry(sampler2D table, int entry) {
  return texelFetch(table, ivec2(entry & 1023, entry >> 10), 0);
}

// What term k of vertex v shows in direction `square`.
vec3 ReadView(int k, int v, vec4 range, vec2 square, ivec3 place) {
  ivec4 tile = ivec4(place, grid);
  if (codebooks != 0) tile = ivec4(VertexEntry(tiles, k * vertex_count + v) + 0.5);
  vec2 texel = vec2(tile.xy) + square * float(tile.w - 1) + 0.5;
  vec3 at = vec3(texel / vec2(textureSize(view_maps, 0).xy), float(view_first[k] + tile.z));
  return range.z * textureLod(view_maps, at, 0.0).rgb + range.w;
}
#endif

void main() {
  gl_Position = clip_from_model * vec4(position, 1.0);
#ifdef LFM_CORNER_TERMS
  corner_bias = vec3(0.0);
#else
  patch_corners = corners;
#endif
  patch_triangle = triangle;
  int corner = gl_VertexID % 3;
  corner_weights = vec3(corner == 0, corner == 1, corner == 2);
  vec3 to_eye = eye - position;
  for (int j = 0; j < 3; ++j) {
    int v = corners[j];
    vec4 x_axis = FrameEntry(v, 0);
    vec4 y_axis = FrameEntry(v, 1);
    corner_terms[j] = int(y_axis.w + 0.5);
    vec3 in_frame = vec3(dot(x_axis.xyz, to_eye), dot(y_axis.xyz, to_eye),
                         dot(FrameEntry(v, 2).xyz, to_eye));
    int slot = int(x_axis.w + 0.5), in_page = slot % view_tiles_per_page;
    ivec3 place = ivec3(in_page % view_tiles_per_row * grid, in_page / view_tiles_per_row * grid,
                        slot / view_tiles_per_page);
#ifdef LFM_CORNER_TERMS
    vec2 square = clamp(SquareFromDirection(normalize(in_frame), direction_map), 0.0, 1.0);
    for (int k = 0; k < LFM_CORNER_TERMS; ++k) {
      vec3 view = vec3(0.0);
      vec4 range = VertexEntry(ranges, k * vertex_count + v);
      if (k < min(terms, corner_terms[j])) view = ReadView(k, v, range, square, place);
      corner_views[3 * k + j] = range.x * view;
      corner_bias += range.y * view;
    }
#else
    view_tile[j] = place;
    view_vector[j] = view_coordinates_per_vertex != 0
                         ? vec3(SquareFromDirection(normalize(in_frame), direction_map), 0.0)
                         : in_frame;
#endif
  }
}
