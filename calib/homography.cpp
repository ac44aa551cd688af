// SPDX-License-Identifier: BSD-3-Clause
#include "calib/homography.h"

#include <Eigen/Dense>
#include <cmath>

namespace lfm {
namespace {

// Relative to the largest singular value; a well-spread tag gives about 0.1.
constexpr double kMinConditioning = 1e-7;

// Centroid to the origin, mean distance sqrt(2).
std::optional<Eigen::Matrix3d> Normalizer(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p / static_cast<double>(points.size());
  double distance = 0;
  for (const Eigen::Vector2d& p : points) {
    distance += (p - mean).norm() / static_cast<double>(points.size());
  }
  if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
  const double scale = std::sqrt(2.0) / distance;
  Eigen::Matrix3d n;
  n << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return n;
}

}  // namespace

std::optional<Eigen::Matrix3d> FitHomography(std::span<const Eigen::Vector2d> from,
                                             std::span<const Eigen::Vector2d> to) {
  if (from.size() < 4 || from.size() != to.size()) return std::nullopt;
  const std::optional<Eigen::Matrix3d> nf = Normalizer(from), nt = Normalizer(to);
  if (!nf || !nt) return std::nullopt;
  // Padding to nine rows makes the SVD return the null vector for four points too.
  const Eigen::Index rows = std::max<Eigen::Index>(9, 2 * static_cast<Eigen::Index>(from.size()));
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, 9);
  for (size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d p = *nf * from[i].homogeneous();
    const Eigen::Vector3d q = *nt * to[i].homogeneous();
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(i);
    a.block<1, 3>(row, 0) = p.transpose();
    a.block<1, 3>(row, 6) = -q.x() * p.transpose();
    a.block<1, 3>(row + 1, 3) = p.transpose();
    a.block<1, 3>(row + 1, 6) = -q.y() * p.transpose();
  }
  // The triangular factor has the singular values and right vectors of the whole.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
  const Eigen::Matrix<double, 9, 9> r =
      qr.matrixQR().topRows<9>().template triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::Matrix<double, 9, 9>> svd(r, Eigen::ComputeFullV);
  if (!(svd.singularValues()(7) > kMinConditioning * svd.singularValues()(0))) return std::nullopt;
  Eigen::Matrix3d h;
  const Eigen::Matrix<double, 9, 1> v = svd.matrixV().col(8);
  h << v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7), v(8);
  h = nt->inverse() * h * *nf;
  if (!h.allFinite()) return std::nullopt;
  return h / h.norm();
}

}  // namespace lfm
