// SPDX-License-Identifier: BSD-3-Clause
// Equation 15 of Yamada 2009 a pixel: weights times products, and the sparse residual times light.
// Tables: model_tables.js; entry i of a long one lies at (i % 2048, i / 2048).

export const kTableWidth = 2048;

export const kVertexShader = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;

export const kFragmentShader = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
precision highp usampler2DArray;
uniform usampler2DArray rows;  // a layer a channel
uniform sampler2D weights;
uniform usampler2D residuals;
uniform sampler2D products;  // of a basis function, by channel; all scales are in them
uniform sampler2D light;     // of a column, by channel
uniform uint most_residuals;
uniform int channels;
uniform int height;      // rows that are drawn
uniform int pixel_step;  // of the picture's pixels, from one that is drawn to the next
out vec4 color;

ivec2 At(uint i) { return ivec2(i & 2047u, i >> 11); }

float Shown(ivec2 pixel, int channel) {
  uvec4 row = texelFetch(rows, ivec3(pixel, channel), 0);
  uint terms = row.w & 0xffffu, count = min(row.w >> 16, most_residuals);
  float sum = 0.0;
  for (uint t = 0u; t < terms; t += 4u) {
    vec4 weight = texelFetch(weights, At(row.x + (t >> 2)), 0);
    for (uint k = 0u; k < 4u && t + k < terms; ++k) {
      sum += weight[k] * texelFetch(products, At(row.y + t + k), 0)[channel];
    }
  }
  for (uint i = 0u; i < count; i += 4u) {
    uvec4 group = texelFetch(residuals, At(row.z + (i >> 2)), 0);
    for (uint k = 0u; k < 4u && i + k < count; ++k) {
      sum += unpackHalf2x16(group[k]).x * texelFetch(light, At(group[k] >> 16), 0)[channel];
    }
  }
  return sum;
}

float Srgb(float linear) {
  float v = clamp(linear, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
}

void main() {
  ivec2 pixel = pixel_step * ivec2(int(gl_FragCoord.x), height - 1 - int(gl_FragCoord.y));
  vec3 shown;
  shown.r = Srgb(Shown(pixel, 0));
  shown.g = channels == 1 ? shown.r : Srgb(Shown(pixel, 1));
  shown.b = channels == 1 ? shown.r : Srgb(Shown(pixel, 2));
  color = vec4(shown, 1.0);
}`;
