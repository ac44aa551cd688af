// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace lfm {

/// Index of a triangle patch's sample that lies `step` steps (0 to n - 1) along `edge` (from corner
/// `edge` to corner `edge + 1` mod 3).
int EdgeSampleIndex(int n, int edge, int step);
/// Index of the sample at a corner.
int CornerSampleIndex(int n, int corner);

/// Which corner of a triangle of its ring the vertex is.
inline int CornerOf(const Eigen::Vector3i& corners, int vertex) {
  return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
}

/// One triangle's side of a shared edge.
struct EdgeUse {
  int patch = 0;          ///< index into the list of patches
  int edge = 0;           ///< of that patch
  bool reversed = false;  ///< the edge runs against the first use's direction
  int edge_samples = 2;   ///< n of that patch
};

/// An edge and the patches on it. A patch is piecewise linear along its edge with n - 1 segments;
/// neighbours of different n can only agree on functions that are piecewise linear over the
/// greatest common divisor of their segment counts. Those `segments + 1` nodes are what the
/// patches share: equal n, or a coarser patch that divides the finer, keep all that the coarser
/// has.
struct SharedEdge {
  std::vector<EdgeUse> uses;
  int segments = 1;
};

/// A mesh vertex and the patch corners that meet there.
struct SharedCorner {
  struct Use {
    int patch = 0, corner = 0, edge_samples = 2;
  };
  std::vector<Use> uses;
};

/// Which samples of neighbouring patches coincide. Boundary edges have one use, edges of a
/// non-manifold mesh more than two.
struct SharedSamples {
  std::vector<SharedEdge> edges;
  std::vector<SharedCorner> corners;
};

/// Finds edges and corners of a list of patches, given the vertex indices of their triangles and
/// their n. Works on a whole mesh and on the ring of one vertex. Order is that of vertex indices.
SharedSamples FindSharedSamples(std::span<const Eigen::Vector3i> triangles,
                                std::span<const int> edge_samples);

/// The samples of one patch: `values[sample * channels + c]`.
struct PatchValues {
  float* values = nullptr;
  bool measured = true;  ///< false: takes the neighbours' values and gives none of its own
};

/// Makes patches continuous: at each corner, then along each edge, the patches' values are averaged
/// (patches that are not measured count only when all are unmeasured) and written back to all of
/// them. Where a patch is finer than the shared nodes, its least squares fit at the nodes enters,
/// and its samples are interpolated linearly between them. Linear functions, and patches without
/// neighbours, stay as they are; running it twice changes nothing more. The result is the same
/// function on both sides of every edge, to rounding.
void MakeContinuous(const SharedSamples& shared, int channels,
                    std::span<const PatchValues> patches);

/// The same for 8-bit codes of patches that MakeContinuous has made equal at the shared nodes and
/// that were quantised with one range: samples between nodes become the rounded interpolation of
/// the nodes' codes, so that the sides of an edge differ by half a code at most.
void MakeCodesContinuous(const SharedSamples& shared, int channels,
                         std::span<uint8_t* const> patches);

}  // namespace lfm
