// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <vector>

#include "resample/light_field.h"

namespace lfm::bench {

inline constexpr size_t kLeastViews = 12;  ///< of a triangle that is asked

/// Squared errors over samples and channels.
struct SquaredError {
  double squares = 0, count = 0;

  void Add(double difference) {
    squares += difference * difference;
    count += 1;
  }
  void Add(const SquaredError& other) {
    squares += other.squares;
    count += other.count;
  }
  double PsnrDb() const { return count > 0 ? -10 * std::log10(squares / count) : 99; }
};

/// A light field and where its photographs were taken from.
struct Object {
  LightField field;
  std::vector<Eigen::Vector3d> centers;  ///< of the light field's photographs
};
/// Reads `work`/resample and `work`/calib. Throws Error when they do not fit together.
Object LoadObject(const std::filesystem::path& work);

/// One triangle, and where its views lie.
struct Views {
  lfm::TrianglePatch patch;
  std::vector<Eigen::Vector3d> to_eye;  // unit, from the centroid

  size_t rows() const { return patch.values.size() / patch.photos.size(); }
  float At(size_t row, size_t view) const {
    return static_cast<float>(patch.values[row * patch.photos.size() + view]) / LightField::kOne;
  }
};

Views ViewsOf(const Object& object, int triangle);

/// Three views and weights, by index into the triangle's views.
struct Mix {
  std::array<size_t, 3> view = {};
  std::array<float, 3> weight = {};
  bool seen = false;
};

/// Delaunay mixes of the views `from`, which lie at `plane`, for every query (ComputeViewWeights).
std::vector<Mix> MixesOf(std::span<const Eigen::Vector2d> plane, std::span<const size_t> from,
                         std::span<const Eigen::Vector2d> queries, double hull_margin);
/// The mix of sRGB-coded values.
float Coded(const Views& views, size_t row, const Mix& mix);

/// Prints how far vertex matrices are from their first terms, of directions in the vertex frame, of
/// directions mirrored in each sample's own normal, and of linear values.
void PrintTerms(const Object& object);

}  // namespace lfm::bench
