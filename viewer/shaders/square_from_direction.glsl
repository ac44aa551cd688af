// SPDX-License-Identifier: BSD-3-Clause
// Where a unit direction in a vertex frame lies on the square [0, 1]^2 of a view map
// (resample/direction_map.h). Below the horizon: moved onto it, same azimuth; straight down: centre.
vec2 SquareFromDirection(vec3 d, bool orthographic_map) {
  if (d.z < 0.0) {
    float flat_length = length(d.xy);
    if (flat_length < 1e-12) return vec2(0.5);
    d = vec3(d.xy / flat_length, 0.0);
  }
  if (orthographic_map) return 0.5 * (d.xy + 1.0);
  vec2 p = d.xy / (abs(d.x) + abs(d.y) + d.z);
  return 0.5 * (vec2(p.x + p.y, p.x - p.y) + 1.0);
}
