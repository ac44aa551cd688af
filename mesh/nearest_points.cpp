// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/nearest_points.h"

#include <cmath>
#include <nanoflann.hpp>

namespace lfm {
namespace {

struct PointAccess {
  const std::vector<Eigen::Vector3d>& points;
  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t index, size_t axis) const {
    return points[index][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointAccess>,
                                                 PointAccess, 3, int>;

}  // namespace

struct NearestPoints::State {
  explicit State(const std::vector<Eigen::Vector3d>& points)
      : access{points}, tree(3, access, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}
  PointAccess access;
  Tree tree;
};

NearestPoints::NearestPoints(const std::vector<Eigen::Vector3d>& points)
    : state_(std::make_unique<State>(points)) {}
NearestPoints::~NearestPoints() = default;

std::vector<NearPoint> NearestPoints::Find(const Eigen::Vector3d& query, int count) const {
  std::vector<int> indices(count);
  std::vector<double> squares(count);
  const size_t found = state_->tree.knnSearch(query.data(), count, indices.data(), squares.data());
  std::vector<NearPoint> result(found);
  for (size_t i = 0; i < found; ++i) result[i] = {indices[i], std::sqrt(squares[i])};
  return result;
}

}  // namespace lfm
