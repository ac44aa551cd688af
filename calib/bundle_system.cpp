// SPDX-License-Identifier: BSD-3-Clause
#include "calib/bundle_system.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace lfm {
namespace {

// As many partial sums whatever the number of threads.
constexpr int64_t kMostChunks = 16;

int64_t ChunkOf(size_t views) {
  return std::max<int64_t>(4, (static_cast<int64_t>(views) + kMostChunks - 1) / kMostChunks);
}

std::vector<int> FreeIndices(const BundleCamera& camera) {
  if (camera.free == FreeIntrinsics::kNone) return {};
  if (camera.free == FreeIntrinsics::kFocalAndRadial) return {0, 1, kFirstLensTerm};
  std::vector<int> free;
  for (int i = 0; i < kFirstLensTerm + camera.lens_terms; ++i) free.push_back(i);
  return free;
}

Eigen::Vector3d BendRow(const Eigen::Vector3d& printed) {
  return {printed.x() * printed.x(), printed.x() * printed.y(), printed.y() * printed.y()};
}

Eigen::Vector3d PointOf(const JointBundle& bundle, const BundleState& state, const BundleView& view,
                        size_t i) {
  if (!bundle.platform) return view.points[i];
  const PlatformUnknowns& platform = *bundle.platform;
  const int corner = view.corners[i], group = platform.group_of_corner[corner];
  Eigen::Vector3d point = platform.printed[corner];
  if (platform.bent) point.z() += BendRow(point).dot(state.platform.tail<3>());
  if (group >= 0) point.head<2>() += state.platform.segment<2>(2 * group);
  return point;
}

double PriorWeight(const PlatformUnknowns& platform) {
  const double ratio = platform.noise_px / platform.prior_mm;
  return ratio * ratio;
}

// The shared unknowns that one corner touches, and its derivatives by them.
struct SharedRow {
  static constexpr int kMost = kIntrinsics + 5;
  int count = 0;
  std::array<int, kMost> index;
  Eigen::Matrix<double, 2, kMost> by;
};

SharedRow MakeSharedRow(const JointBundle& bundle, const BundleLayout& layout,
                        const BundleView& view, size_t i, const CornerProjection& projection) {
  SharedRow row;
  const auto add = [&row](int index, const Eigen::Vector2d& by) {
    row.index[row.count] = index;
    row.by.col(row.count++) = by;
  };
  const std::vector<int>& free = layout.free_intrinsics[view.camera];
  for (size_t k = 0; k < free.size(); ++k) {
    add(layout.first_intrinsic[view.camera] + static_cast<int>(k),
        projection.by_intrinsics.col(free[k]));
  }
  if (!bundle.platform) return row;
  const int corner = view.corners[i], group = bundle.platform->group_of_corner[corner];
  if (group >= 0) {
    for (int c = 0; c < 2; ++c) {
      add(layout.first_shift + 2 * group + c, projection.by_point.col(c));
    }
  }
  if (bundle.platform->bent) {
    const Eigen::Vector3d bend = BendRow(bundle.platform->printed[corner]);
    for (int c = 0; c < 3; ++c) add(layout.first_bend + c, projection.by_point.col(2) * bend(c));
  }
  return row;
}

ViewSystem LinearizeView(const JointBundle& bundle, const BundleLayout& layout,
                         const BundleState& state, size_t v, double robust_scale_px,
                         Eigen::MatrixXd& shared, Eigen::VectorXd& gradient) {
  const BundleView& view = bundle.views[v];
  ViewSystem system;
  system.shared_by_pose.setZero(layout.shared, 6);
  const Camera& camera = state.cameras[view.camera];
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    const CornerProjection p =
        ProjectCorner(camera, state.poses[v], PointOf(bundle, state, view, i), view.pixels[i]);
    Eigen::Matrix2d weight = view.WeightOf(i);
    if (robust_scale_px > 0) {
      weight /= 1 + view.SquareOf(i, p.residual) / (robust_scale_px * robust_scale_px);
    }
    const Eigen::Matrix<double, 6, 2> pose_weighted = p.by_pose.transpose() * weight;
    system.pose.noalias() += pose_weighted * p.by_pose;
    system.gradient.noalias() += pose_weighted * p.residual;
    const SharedRow row = MakeSharedRow(bundle, layout, view, i, p);
    for (int a = 0; a < row.count; ++a) {
      const Eigen::Vector2d by = weight * row.by.col(a);
      gradient(row.index[a]) += by.dot(p.residual);
      system.shared_by_pose.row(row.index[a]).noalias() += by.transpose() * p.by_pose;
      for (int b = 0; b < row.count; ++b) {
        shared(row.index[a], row.index[b]) += by.dot(row.by.col(b));
      }
    }
  }
  return system;
}

}  // namespace

BundleLayout MakeLayout(const JointBundle& bundle) {
  BundleLayout layout;
  for (const BundleCamera& camera : bundle.cameras) {
    layout.free_intrinsics.push_back(FreeIndices(camera));
    layout.first_intrinsic.push_back(layout.shared);
    layout.shared += static_cast<int>(layout.free_intrinsics.back().size());
  }
  layout.first_shift = layout.shared;
  layout.first_bend = layout.shared + (bundle.platform ? 2 * bundle.platform->groups : 0);
  layout.shared += bundle.platform ? bundle.platform->Count() : 0;
  return layout;
}

BundleState StartState(const JointBundle& bundle) {
  BundleState state;
  for (const BundleCamera& camera : bundle.cameras) state.cameras.push_back(camera.camera);
  for (const BundleView& view : bundle.views) state.poses.push_back(view.camera_from_world);
  state.platform.setZero(bundle.platform ? bundle.platform->Count() : 0);
  return state;
}

BundleState MoveState(const JointBundle& bundle, const BundleLayout& layout,
                      const BundleState& state, const Eigen::VectorXd& shared_step,
                      const std::vector<Eigen::Matrix<double, 6, 1>>& pose_steps) {
  BundleState moved = state;
  for (size_t c = 0; c < moved.cameras.size(); ++c) {
    Eigen::Matrix<double, kIntrinsics, 1> values = PackIntrinsics(moved.cameras[c]);
    const std::vector<int>& free = layout.free_intrinsics[c];
    for (size_t k = 0; k < free.size(); ++k) {
      values(free[k]) += shared_step(layout.first_intrinsic[c] + static_cast<Eigen::Index>(k));
    }
    moved.cameras[c] = UnpackIntrinsics(moved.cameras[c], values);
  }
  for (size_t v = 0; v < moved.poses.size(); ++v) {
    if (!bundle.views[v].pixels.empty()) moved.poses[v] = MovePose(moved.poses[v], pose_steps[v]);
  }
  moved.platform += shared_step.tail(state.platform.size());
  return moved;
}

PlatformShape ShapeOfState(const JointBundle& bundle, const BundleState& state) {
  PlatformShape shape;
  if (!bundle.platform) return shape;
  const PlatformUnknowns& platform = *bundle.platform;
  if (platform.bent) shape.bend_per_mm = state.platform.tail<3>();
  if (platform.groups == 0) return shape;
  for (const int group : platform.group_of_corner) {
    shape.shifts_mm.push_back(group < 0 ? Eigen::Vector2d(0, 0)
                                        : Eigen::Vector2d(state.platform.segment<2>(2 * group)));
  }
  return shape;
}

BundleSystem Linearize(const JointBundle& bundle, const BundleLayout& layout,
                       const BundleState& state, double robust_scale_px) {
  const int64_t count = static_cast<int64_t>(bundle.views.size());
  const int64_t chunk = ChunkOf(bundle.views.size());
  const size_t chunks = static_cast<size_t>((count + chunk - 1) / chunk);
  std::vector<Eigen::MatrixXd> shared(chunks);
  std::vector<Eigen::VectorXd> gradients(chunks);
  BundleSystem system;
  system.views.resize(bundle.views.size());
  ParallelChunks(count, chunk, [&](int64_t begin, int64_t end, int64_t c) {
    shared[c].setZero(layout.shared, layout.shared);
    gradients[c].setZero(layout.shared);
    for (int64_t v = begin; v < end; ++v) {
      system.views[v] = LinearizeView(bundle, layout, state, static_cast<size_t>(v),
                                      robust_scale_px, shared[c], gradients[c]);
    }
  });
  system.shared.setZero(layout.shared, layout.shared);
  system.gradient.setZero(layout.shared);
  for (size_t c = 0; c < chunks; ++c) {
    system.shared += shared[c];
    system.gradient += gradients[c];
  }
  if (bundle.platform) {
    const double weight = PriorWeight(*bundle.platform);
    for (int i = layout.first_shift; i < layout.first_bend; ++i) {
      system.shared(i, i) += weight;
      system.gradient(i) += weight * state.platform(i - layout.first_shift);
    }
  }
  return system;
}

double BundleCost(const JointBundle& bundle, const BundleState& state, double robust_scale_px) {
  const double scale2 = robust_scale_px * robust_scale_px;
  std::vector<double> costs(bundle.views.size());
  ParallelFor(
      0, static_cast<int64_t>(costs.size()),
      [&](int64_t v) {
        const BundleView& view = bundle.views[v];
        for (size_t i = 0; i < view.pixels.size(); ++i) {
          const double squared =
              view.SquareOf(i, CornerResidual(state.cameras[view.camera], state.poses[v],
                                              PointOf(bundle, state, view, i), view.pixels[i]));
          costs[v] += robust_scale_px > 0 ? scale2 * std::log1p(squared / scale2) : squared;
        }
      },
      16);
  double cost = 0;
  for (const double c : costs) cost += c;
  if (bundle.platform) {
    cost += PriorWeight(*bundle.platform) *
            state.platform.head(2 * bundle.platform->groups).squaredNorm();
  }
  return cost;
}

ReducedSystem EliminatePoses(const BundleSystem& system, double damping) {
  const Eigen::Index n = system.shared.rows();
  const int64_t count = static_cast<int64_t>(system.views.size());
  const int64_t chunk = ChunkOf(system.views.size());
  const size_t chunks = static_cast<size_t>((count + chunk - 1) / chunk);
  std::vector<Eigen::MatrixXd> sums(chunks);
  ReducedSystem reduced;
  reduced.eliminated.resize(system.views.size());
  ParallelChunks(count, chunk, [&](int64_t begin, int64_t end, int64_t c) {
    sums[c].setZero(n, n + 1);
    for (int64_t v = begin; v < end; ++v) {
      const ViewSystem& view = system.views[v];
      if (view.pose.isZero(0)) continue;
      Eigen::Matrix<double, 6, 6> block = view.pose;
      block.diagonal() *= 1 + damping;
      Eigen::Matrix<double, 6, Eigen::Dynamic> right(6, n + 1);
      right << view.shared_by_pose.transpose(), view.gradient;
      reduced.eliminated[v] = block.ldlt().solve(right);
      sums[c].noalias() += view.shared_by_pose * reduced.eliminated[v];
    }
  });
  reduced.information = system.shared;
  reduced.information.diagonal() *= 1 + damping;
  reduced.gradient = system.gradient;
  for (const Eigen::MatrixXd& sum : sums) {
    reduced.information -= sum.leftCols(n);
    reduced.gradient -= sum.col(n);
  }
  return reduced;
}

}  // namespace lfm
