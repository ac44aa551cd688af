// SPDX-License-Identifier: BSD-3-Clause
#include "scan/projector_resection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace lfm {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

constexpr size_t kMinPoints = 12;
constexpr int kTrimRounds = 3;
constexpr double kKeptShare = 0.9;

[[noreturn]] void ThrowNoPinhole() {
  throw Error(
      "no projector fits the decoded platform placements: tilt the platform in different "
      "directions, and check that picture and projector are not mirrored");
}

Eigen::Matrix3d Covariance(const std::vector<ResectionPoint>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ResectionPoint& p : points) mean += p.point_in_camera;
  mean /= static_cast<double>(std::max<size_t>(1, points.size()));
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const ResectionPoint& p : points) {
    const Eigen::Vector3d d = p.point_in_camera - mean;
    covariance += d * d.transpose();
  }
  return covariance;
}

/// Similarities that bring points and pixels to zero mean and unit scale.
struct Normalization {
  Eigen::Vector3d point_mean;
  double point_scale = 1;
  Eigen::Vector2d pixel_mean;
  double pixel_scale = 1;
};

Normalization Normalize(const std::vector<ResectionPoint>& points) {
  Normalization n{Eigen::Vector3d::Zero(), 1, Eigen::Vector2d::Zero(), 1};
  double rows = 0;
  for (const ResectionPoint& p : points) {
    n.point_mean += p.point_in_camera;
    n.pixel_mean.x() += p.projector_px.x();
    if (!p.has_row) continue;
    n.pixel_mean.y() += p.projector_px.y();
    rows += 1;
  }
  const double count = static_cast<double>(points.size());
  n.point_mean /= count;
  n.pixel_mean.x() /= count;
  n.pixel_mean.y() /= std::max(1.0, rows);
  double point_spread = 0, pixel_spread = 0;
  for (const ResectionPoint& p : points) {
    point_spread += (p.point_in_camera - n.point_mean).squaredNorm();
    pixel_spread += std::pow(p.projector_px.x() - n.pixel_mean.x(), 2);
  }
  n.point_scale = std::sqrt(3 * count / std::max(point_spread, 1e-300));
  n.pixel_scale = std::sqrt(count / std::max(pixel_spread, 1e-300));
  return n;
}

void AddEquation(Matrix12& gram, int line, const Eigen::Vector4d& point, double value) {
  Vector12 row = Vector12::Zero();
  row.segment<4>(4 * line) = point;
  row.segment<4>(8) = -value * point;
  gram.selfadjointView<Eigen::Lower>().rankUpdate(row);
}

Matrix34 SolveDlt(const std::vector<ResectionPoint>& points) {
  const Normalization n = Normalize(points);
  Matrix12 gram = Matrix12::Zero();
  for (const ResectionPoint& p : points) {
    Eigen::Vector4d point;
    point << (p.point_in_camera - n.point_mean) * n.point_scale, 1;
    const Eigen::Vector2d pixel = (p.projector_px - n.pixel_mean) * n.pixel_scale;
    AddEquation(gram, 0, point, pixel.x());
    if (p.has_row) AddEquation(gram, 1, point, pixel.y());
  }
  const Eigen::SelfAdjointEigenSolver<Matrix12> solver(gram);
  const Vector12 solution = solver.eigenvectors().col(0);
  Matrix34 normalized;
  for (int line = 0; line < 3; ++line) normalized.row(line) = solution.segment<4>(4 * line);

  Eigen::Matrix3d pixel_from_normalized = Eigen::Matrix3d::Identity();
  pixel_from_normalized.diagonal().head<2>().setConstant(1 / n.pixel_scale);
  pixel_from_normalized.col(2).head<2>() = n.pixel_mean;
  Eigen::Matrix4d normalized_from_point = Eigen::Matrix4d::Identity();
  normalized_from_point.diagonal().head<3>().setConstant(n.point_scale);
  normalized_from_point.col(3).head<3>() = -n.point_scale * n.point_mean;
  return pixel_from_normalized * normalized * normalized_from_point;
}

double ResidualPx(const Matrix34& matrix, const ResectionPoint& p) {
  const Eigen::Vector3d h = matrix * p.point_in_camera.homogeneous();
  const Eigen::Vector2d d = h.hnormalized() - p.projector_px;
  const double length = p.has_row ? d.norm() : std::abs(d.x());
  return std::isfinite(length) ? length : 1e300;
}

std::vector<ResectionPoint> KeepBest(const Matrix34& matrix,
                                     const std::vector<ResectionPoint>& points) {
  std::vector<double> residuals;
  for (const ResectionPoint& p : points) residuals.push_back(ResidualPx(matrix, p));
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return residuals[a] < residuals[b]; });
  const size_t kept =
      std::max(kMinPoints, static_cast<size_t>(kKeptShare * static_cast<double>(points.size())));
  order.resize(std::min(kept, order.size()));
  std::sort(order.begin(), order.end());
  std::vector<ResectionPoint> best;
  for (size_t i : order) best.push_back(points[i]);
  return best;
}

/// Splits P = K [R | t] (the QR form: M^-1 = R^T K^-1), dropping the skew.
Resection Decompose(const Matrix34& raw, int width, int height) {
  const Matrix34 matrix = raw.leftCols<3>().determinant() < 0 ? Matrix34(-raw) : raw;
  const Eigen::Matrix3d m = matrix.leftCols<3>();
  if (!(m.determinant() > 0)) ThrowNoPinhole();
  const Eigen::HouseholderQR<Eigen::Matrix3d> qr(m.inverse());
  Eigen::Matrix3d q = qr.householderQ();
  Eigen::Matrix3d upper = qr.matrixQR().triangularView<Eigen::Upper>();
  for (int i = 0; i < 3; ++i) {
    if (upper(i, i) >= 0) continue;
    upper.row(i) *= -1;
    q.col(i) *= -1;
  }
  const Eigen::Matrix3d k = upper.inverse();
  Resection result;
  result.projector.width = width;
  result.projector.height = height;
  result.projector.fx = k(0, 0) / k(2, 2);
  result.projector.fy = k(1, 1) / k(2, 2);
  result.projector.cx = k(0, 2) / k(2, 2);
  result.projector.cy = k(1, 2) / k(2, 2);
  result.projector_from_camera.rotation = q.transpose();
  result.projector_from_camera.translation = upper * matrix.col(3);
  const bool sane = std::isfinite(result.projector.fx) && std::isfinite(result.projector.fy) &&
                    result.projector.fx > 0 && result.projector.fy > 0 && q.determinant() > 0 &&
                    result.projector_from_camera.translation.allFinite();
  if (!sane) ThrowNoPinhole();
  return result;
}

}  // namespace

double CloudThickness(const std::vector<ResectionPoint>& points) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(Covariance(points));
  const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(0.0);
  return values(2) > 0 ? std::sqrt(values(0) / values(2)) : 0;
}

Resection ResectProjector(const std::vector<ResectionPoint>& points, int width, int height) {
  if (points.size() < kMinPoints) {
    throw Error("only " + std::to_string(points.size()) +
                " decoded points of the platform: too few to locate the projector");
  }
  for (const ResectionPoint& p : points) {
    if (!p.point_in_camera.allFinite() || !p.projector_px.allFinite()) {
      throw Error("a decoded point of the platform is not finite", ErrorKind::kSystem);
    }
  }
  Matrix34 matrix = SolveDlt(points);
  for (int round = 0; round < kTrimRounds; ++round) matrix = SolveDlt(KeepBest(matrix, points));
  const Resection result = Decompose(matrix, width, height);
  size_t in_front = 0;
  for (const ResectionPoint& p : points) {
    in_front += (result.projector_from_camera * p.point_in_camera).z() > 0 ? 1 : 0;
  }
  if (2 * in_front < points.size()) ThrowNoPinhole();
  return result;
}

}  // namespace lfm
