// SPDX-License-Identifier: BSD-3-Clause
// Where a unit direction in a vertex frame lies on the square [0, 1]^2 of a view map
// (resample/direction_map.h); layout: 1 is the disc, 2 has a skirt. Below the lowest directions:
// moved onto them, same azimuth; straight down: centre.
vec2 SquareFromDirection(vec3 d, int layout_of_map) {
  float lowest = layout_of_map == 2 ? -0.35 : 0.0;
  if (d.z < lowest) {
    float flat_length = length(d.xy);
    if (flat_length < 1e-12) return vec2(0.5);
    d = vec3(d.xy * (sqrt(1.0 - lowest * lowest) / flat_length), lowest);
  }
  if (layout_of_map == 1) return 0.5 * (d.xy + 1.0);
  vec2 p = d.xy / (abs(d.x) + abs(d.y) + (d.z - lowest) / (1.0 - lowest));
  return 0.5 * (vec2(p.x + p.y, p.x - p.y) + 1.0);
}
