// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resample/direction_map.h"
#include "resample_views.h"

namespace lfm::bench {

using Matrix = Eigen::MatrixXd;

inline constexpr int kChannels = 3;
inline constexpr auto kMap = DirectionMap::kHemiOctahedral;

/// One triangle of a ring.
struct RingPatch {
  Views views;
  Eigen::Index first_row = 0;
  std::vector<double> hats;               ///< a row each: of the samples that have weight
  std::vector<size_t> samples;            ///< as `hats`
  std::vector<Eigen::Vector3d> in_frame;  ///< of the vertex: where its photographs stand
  std::vector<size_t> kept, left_out;     ///< views
};

/// A vertex ring without the photographs that are left out.
struct Ring {
  std::vector<RingPatch> patches;
  std::vector<uint16_t> photos;           ///< kept by any of its triangles
  std::vector<Eigen::Vector3d> in_frame;  ///< as `photos`: from the vertex
  Eigen::Index rows = 0;
};

/// Every third photograph is left out.
Ring RingOf(const Object& object, int vertex, std::span<const int> triangles);

/// Weights of sites (rows) in blends for the queries (columns), on the plane of the direction map.
Matrix Blends(std::span<const Eigen::Vector3d> sites, std::span<const size_t> from,
              std::span<const Eigen::Vector2d> queries);

/// Bilinear weights of the directions of a grid (`grid` a side) for one direction, as the renderers
/// have them.
Eigen::VectorXd GridTaps(int grid, const Eigen::Vector3d& direction);

/// A patch's rows times hats, of views in columns, channels outer.
Matrix PatchMatrix(const RingPatch& patch);

/// Values of a channel each, of rows x (channel, column).
inline auto Channel(const Matrix& matrix, int c) {
  return matrix.middleCols(c * (matrix.cols() / kChannels), matrix.cols() / kChannels);
}

/// A ring matrix without its mean a row and channel.
struct Centred {
  Matrix values, mean;
};

Centred Centre(Matrix values);

/// Hat-weighted rows x (channel, grid direction).
Matrix ResampledMatrix(const Ring& ring, int grid);

/// Rows x (channel, photograph), without each row's mean over what it knows; 0 where unknown.
struct PhotoMatrix {
  Matrix values, mean, known;
};

PhotoMatrix PhotographsOf(const Ring& ring);

}  // namespace lfm::bench
