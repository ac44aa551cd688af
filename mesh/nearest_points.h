// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace lfm {

/// A point that a query found.
struct NearPoint {
  int index = -1;
  double distance = 0;  ///< mm
};

/// A kd-tree over points (nanoflann), which must outlive it. Immutable; safe to use from many
/// threads; ties are broken the same way every time.
class NearestPoints {
 public:
  explicit NearestPoints(const std::vector<Eigen::Vector3d>& points);
  ~NearestPoints();

  /// The `count` points nearest to `query` (fewer when there are fewer), nearest first.
  std::vector<NearPoint> Find(const Eigen::Vector3d& query, int count) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
