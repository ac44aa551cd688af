#version 330 core
// SPDX-License-Identifier: BSD-3-Clause
// colour = mean + sum over terms k and corners j of surface map [k, j] times view map [k, j]
// (Chen 2002, Equations 3 and 6), on sRGB-coded values, in float, clamped once at the end.

centroid in vec3 view_vector[3];
centroid in vec2 patch_texel;
centroid in vec3 corner_weights;
flat in int patch_page;
flat in ivec3 patch_corners;
flat in ivec3 corner_terms;
flat in ivec3 view_tile[3];

uniform sampler2DArray mean_maps;
uniform sampler2DArray surface_maps;
uniform sampler2DArray view_maps;
uniform sampler2D ranges;
uniform int table_width;
uniform int terms;
uniform int vertex_count;
uniform int grid;
uniform int surface_first[16];  // layer of each term's first page
uniform int view_first[16];
uniform int orthographic;
uniform int view_coordinates_per_vertex;
uniform int mean_in_terms;
uniform int wireframe;

out vec4 color;

//#include square_from_direction

// Texel centres are integers here and halves in OpenGL.
vec3 ReadTexel(sampler2DArray maps, vec2 texel, int layer) {
  return textureLod(maps, vec3((texel + 0.5) / vec2(textureSize(maps, 0).xy), float(layer)), 0.0)
      .rgb;
}

vec4 Range(int term, int vertex) {
  int entry = term * vertex_count + vertex;
  return texelFetch(ranges, ivec2(entry % table_width, entry / table_width), 0);
}

// 1 on the triangle's edges, falling to 0 within a pixel and a quarter.
float EdgeShare() {
  vec3 pixels = corner_weights / max(fwidth(corner_weights), vec3(1e-9));
  return 1.0 - smoothstep(0.25, 1.25, min(pixels.x, min(pixels.y, pixels.z)));
}

void main() {
  vec2 view_texel[3];
  for (int j = 0; j < 3; ++j) {
    vec2 square = view_coordinates_per_vertex != 0
                      ? view_vector[j].xy
                      : SquareFromDirection(normalize(view_vector[j]), orthographic != 0);
    view_texel[j] = vec2(view_tile[j].xy) + clamp(square, 0.0, 1.0) * float(grid - 1);
  }
  // Corners whose terms do not hold the mean view show it themselves.
  float mean_share = 1.0;
  if (mean_in_terms != 0 && terms > 0) {
    mean_share = 0.0;
    for (int j = 0; j < 3; ++j) {
      if (corner_terms[j] == 0) mean_share += corner_weights[j];
    }
  }
  vec3 sum = mean_share * ReadTexel(mean_maps, patch_texel, patch_page);
  for (int k = 0; k < terms; ++k) {
    vec3 surface = ReadTexel(surface_maps, patch_texel, surface_first[k] + patch_page);
    for (int j = 0; j < 3; ++j) {
      vec4 range = Range(k, patch_corners[j]);
      vec3 view = ReadTexel(view_maps, view_texel[j], view_first[k] + view_tile[j].z);
      sum += (range.x * surface[j] + range.y) * (range.z * view + range.w);
    }
  }
  if (wireframe != 0) sum = mix(sum, vec3(0.15, 0.75, 1.0), 0.7 * EdgeShare());
  color = vec4(clamp(sum, 0.0, 1.0), 1.0);
}
