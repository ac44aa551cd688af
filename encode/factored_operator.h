// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/light_field_source.h"
#include "encode/pca.h"

namespace lfm {

/// One triangle of a vertex ring: the factors of its rows of F^v.
///
/// Rows are the triangle's samples, columns are (channel, direction):
///   F_t = diag(hat) ((P_t - m_t 1^T) W_t + B change_t)
/// (B, samples x 3: the barycentric weights of all corners).
/// `centred` holds diag(hat) (P_t - m_t 1^T) as samples x (3 views), channels outer; centring
/// before the product is exact since each column of W_t sums to one.
struct RingBlock {
  int triangle = 0;
  int corner = 0;  ///< which corner of the triangle the vertex is
  int edge_samples = 2;
  int samples = 0, views = 0;  ///< views = 0: seen by nobody, the rows of F are zero
  int first_row = 0;
  std::vector<float> hat;      ///< samples; barycentric weight of the corner
  std::vector<float> centred;  ///< samples x 3 x views
  std::vector<uint16_t> view;  ///< 3 a direction, as ViewWeights
  std::vector<float> weight;   ///< 3 a direction
  std::vector<uint8_t> seen;   ///< a direction
  std::vector<float> change;   ///< 3 x 3 N (LightFieldSource::change); empty: nothing
  std::vector<float> shares;   ///< samples x 3: hat times B, where there is a change
  std::vector<int> offsets;    ///< W sorted by view: views + 1 offsets into the next two
  std::vector<uint16_t> direction_by_view;
  std::vector<float> weight_by_view;
};

/// The mean view of one triangle: samples x 3, sRGB-coded [0, 1].
using PatchMean = std::vector<float>;

/// The light field matrix F^v of one vertex (Chen 2002, Equations 2 and 4), monochrome surface maps
/// layout: M x 3N, never formed (DESIGN 4).
struct VertexOperator {
  std::vector<RingBlock> blocks;
  int rows = 0;        ///< M, samples of the ring
  int directions = 0;  ///< N = grid^2
  double max_abs = 0;  ///< bound on |F|

  int cols() const { return 3 * directions; }
};

/// Reads the blocks of a vertex ring. `triangles` is the ring; `mean(t)` the mean view of its
/// triangle t. Throws Error when a block's sizes do not fit.
VertexOperator BuildVertexOperator(const LightFieldSource& source, int vertex,
                                   std::span<const int> triangles,
                                   const std::function<PatchMean(int triangle)>& mean);

/// y = F x and x = F^T y; x is (3N x width), y (M x width), row-major; width 8, 16 or 24. About
/// 4 M (3 views) width + 18 N width flops a triangle. float32: errors of about 1e-6 of the largest.
void Multiply(const VertexOperator& f, const float* x, int width, float* y);
void MultiplyTransposed(const VertexOperator& f, const float* y, int width, float* x);

/// F diag(column_scale) as a map for ComputePca; `column_scale` has N entries, used for each
/// channel. Both arguments must outlive the result.
LinearMap ScaledMap(const VertexOperator& f, const std::vector<float>& column_scale);

/// ||F||^2 and the squared norm of F diag(column_scale), without forming F: the sum over triangles
/// and channels of <P^T P, W D^2 W^T>.
struct Energies {
  double plain = 0, scaled = 0;
};
Energies ComputeEnergies(const VertexOperator& f, const std::vector<float>& column_scale);

}  // namespace lfm
