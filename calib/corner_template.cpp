// SPDX-License-Identifier: BSD-3-Clause
#include "calib/corner_template.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {
namespace {

// Even Fibonacci numbers make the lattice (i + 1/2) / N, frac((i + 1/2) G / N) symmetric about its
// middle without a point on the border.
constexpr int kLatticePoints = 34;
constexpr int kLatticeGenerator = 21;
constexpr double kNoBlurPx = 1e-3;

// Integral of the normal distribution function.
double IntegratedNormal(double t, double sigma) {
  const double z = t / sigma;
  return t * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
         sigma * std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
}

// Quantile of a unit box convolved with a Gaussian, by bisection.
double BlurredBoxQuantile(double probability, double sigma) {
  if (sigma < kNoBlurPx) return probability - 0.5;
  double low = -0.5 - 6 * sigma, high = 0.5 + 6 * sigma;
  for (int i = 0; i < 60; ++i) {
    const double x = (low + high) / 2;
    const double below = IntegratedNormal(x + 0.5, sigma) - IntegratedNormal(x - 0.5, sigma);
    (below < probability ? low : high) = x;
  }
  return (low + high) / 2;
}

// o = slope n + curvature (nx^2, nx ny, ny^2): pixels round a point, by normalised coordinates.
struct LensTaylor {
  Eigen::Matrix2d slope;
  Eigen::Matrix<double, 2, 3> curvature;
};

LensTaylor ExpandLens(const Camera& camera, const Eigen::Vector2d& normalized) {
  // Wide enough for second differences in double precision, narrow against the lens's third order.
  constexpr double kStep = 1e-3;
  const auto at = [&](double dx, double dy) -> Eigen::Vector2d {
    const Eigen::Vector2d d = Distort(camera, normalized + kStep * Eigen::Vector2d(dx, dy));
    return {camera.fx * d.x(), camera.fy * d.y()};
  };
  const Eigen::Vector2d here = at(0, 0), right = at(1, 0), left = at(-1, 0), below = at(0, 1),
                        above = at(0, -1);
  LensTaylor lens;
  lens.slope.col(0) = (right - left) / (2 * kStep);
  lens.slope.col(1) = (below - above) / (2 * kStep);
  lens.curvature.col(0) = (right - 2 * here + left) / (2 * kStep * kStep);
  lens.curvature.col(1) = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * kStep * kStep);
  lens.curvature.col(2) = (below - 2 * here + above) / (2 * kStep * kStep);
  return lens;
}

}  // namespace

PixelFootprint MakePixelFootprint(double blur_px) {
  PixelFootprint footprint;
  for (int i = 0; i < kLatticePoints; ++i) {
    const double u = (i + 0.5) / kLatticePoints;
    const double v = std::fmod((i + 0.5) * kLatticeGenerator / kLatticePoints, 1.0);
    footprint.offsets.emplace_back(BlurredBoxQuantile(u, blur_px), BlurredBoxQuantile(v, blur_px));
    footprint.reach = std::max(footprint.reach, footprint.offsets.back().norm());
  }
  footprint.tail = std::max(footprint.reach, 0.7072 + 3.5 * blur_px);
  return footprint;
}

std::optional<LocalView> MakeLocalView(const Camera& camera, const Pose& camera_from_world,
                                       const Eigen::Vector3d& board_point) {
  const Eigen::Vector3d point = camera_from_world * board_point;
  const std::optional<Eigen::Vector2d> pixel = Project(camera, point);
  if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
  LocalView view;
  view.pixel = *pixel;
  view.normalized = point.hnormalized();
  const LensTaylor lens = ExpandLens(camera, view.normalized);
  view.normalized_by_pixel = lens.slope.inverse();
  // n = A o - A H(A o): the inverse of o = L n + H(n) to second order.
  const Eigen::Matrix2d& a = view.normalized_by_pixel;
  const double ax = a(0, 0), bx = a(0, 1), ay = a(1, 0), by = a(1, 1);
  Eigen::Matrix3d monomials;                   // of A o, in those of o
  monomials << ax * ax, 2 * ax * bx, bx * bx,  //
      ax * ay, ax * by + bx * ay, bx * by,     //
      ay * ay, 2 * ay * by, by * by;
  view.curvature = -a * lens.curvature * monomials;
  Eigen::Matrix3d ray_from_board = camera_from_world.rotation;
  ray_from_board.col(2) = camera_from_world.translation;
  view.board_from_normalized = ray_from_board.inverse();
  if (!view.board_from_normalized.allFinite() || !view.curvature.allFinite()) return std::nullopt;
  return view;
}

double RenderPixel(const BoardPrint& print, const LocalView& view, const PixelFootprint& footprint,
                   const Eigen::Vector2d& offset) {
  const double x = offset.x(), y = offset.y();
  const Eigen::Vector2d normalized = view.normalized + view.normalized_by_pixel * offset +
                                     view.curvature * Eigen::Vector3d(x * x, x * y, y * y);
  Eigen::Matrix2d normalized_by_offset = view.normalized_by_pixel;
  normalized_by_offset.col(0) += view.curvature * Eigen::Vector3d(2 * x, y, 0);
  normalized_by_offset.col(1) += view.curvature * Eigen::Vector3d(0, x, 2 * y);
  const Eigen::Matrix3d& h = view.board_from_normalized;
  const Eigen::Vector3d p = h * normalized.homogeneous();
  // The third coordinate is the reciprocal depth.
  if (!(p.z() > 0)) return -1;
  const Eigen::Vector2d board = p.hnormalized();
  const Eigen::Matrix2d slope =
      (h.topLeftCorner<2, 2>() - board * h.bottomLeftCorner<1, 2>()) / p.z() * normalized_by_offset;
  const double scale = slope.norm();
  // Also refuses what is not finite.
  if (!(print.DistanceToPlateEdge(board) > footprint.tail * scale)) return -1;
  if (print.UniformRadius(board) > scale * footprint.reach) return print.Value(board);
  double sum = 0;
  for (const Eigen::Vector2d& o : footprint.offsets) {
    sum += print.Value(board + slope * o);
  }
  return sum / static_cast<double>(footprint.offsets.size());
}

}  // namespace lfm
