// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lfm {

/// Patches about one centre, each within the next: patch k is the first `sizes[k]` of `points`.
struct NestedPatches {
  int64_t center = 0;
  std::vector<int64_t> points;  ///< by distance from the centre, which is the first
  std::vector<int64_t> sizes;   ///< ascending; the area in pixels or vertices, as the paper counts
};

/// Which areas are wanted: from `min_area` on, each 2^(1 / steps_an_octave) times the one before,
/// up to `max_area`. Whole rings of equal distance are taken, so that patches are symmetric and
/// areas may be larger than wanted by one ring; what is not there is not counted.
struct PatchAreas {
  int64_t min_area = 16, max_area = 4096;
  int steps_an_octave = 2;
};

/// Outlines of patches of pixels; both hold occupied pixels only, and shrink where the picture or
/// the object ends.
enum class PatchShape { kDisc, kSquare };

/// Of a picture of width x height pixels, row by row. `occupied`: one number a pixel, 0: not part
/// of any patch. Throws Error when sizes do not fit, the centre is not an occupied pixel, or areas
/// are out of range (1 <= min_area <= max_area, 1 to 16 steps).
NestedPatches PixelPatches(int width, int height, const std::vector<uint8_t>& occupied,
                           int64_t center, PatchShape shape, const PatchAreas& areas);

/// Of vertices, by distance in space. `occupied` as above, one number a vertex.
NestedPatches VertexPatches(const std::vector<Eigen::Vector3f>& positions,
                            const std::vector<uint8_t>& occupied, int64_t center,
                            const PatchAreas& areas);

/// The same by length along the mesh's edges (Dijkstra): parts of the object that are close in
/// space but not along the surface stay out, and so does what no edge leads to. Paths may lead
/// through vertices that are not occupied.
NestedPatches GeodesicPatches(const std::vector<Eigen::Vector3f>& positions,
                              const std::vector<Eigen::Vector3i>& triangles,
                              const std::vector<uint8_t>& occupied, int64_t center,
                              const PatchAreas& areas);

/// `count` occupied points (fewer where there are fewer) spread evenly: at equal steps along a
/// Z-order curve through them. `places`: one a point, in any unit; of pixels (x, y, 0).
std::vector<int64_t> SpreadCenters(const std::vector<Eigen::Vector3f>& places,
                                   const std::vector<uint8_t>& occupied, int count);

}  // namespace lfm
