// SPDX-License-Identifier: BSD-3-Clause
#include "calib/corner_template.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

// Even Fibonacci numbers make the lattice (i + 1/2) / N, frac((i + 1/2) G / N) symmetric about its
// middle without a point on the border.
struct Lattice {
  int points, generator;
};
constexpr Lattice kCoarseLattice = {34, 21}, kFineLattice = {144, 89};
constexpr double kSharpPx = 0.5;

// x^2, x y, y^2, x^3, x^2 y, x y^2, y^3 of an offset.
constexpr int kBends = 7;
using BendTerms = Eigen::Matrix<double, kBends, 1>;

BendTerms TermsOf(const Eigen::Vector2d& o) {
  const double xx = o.x() * o.x(), xy = o.x() * o.y(), yy = o.y() * o.y();
  BendTerms terms;
  terms << xx, xy, yy, xx * o.x(), xx * o.y(), yy * o.x(), yy * o.y();
  return terms;
}

Eigen::Matrix<double, kBends, 2> SlopeOfTerms(const Eigen::Vector2d& o) {
  const double x = o.x(), y = o.y();
  Eigen::Matrix<double, kBends, 2> slope;
  slope << 2 * x, 0, y, x, 0, 2 * y, 3 * x * x, 0, 2 * x * y, x * x, y * y, 2 * x * y, 0, 3 * y * y;
  return slope;
}

// Second and third order of the lens round a pixel that sees `normalized`: by how much an offset
// differs from the one under which a linear lens would show the same point. Least squares over a
// window; no answer where the lens folds back.
std::optional<Eigen::Matrix<double, 2, kBends>> LensBend(
    const Camera& camera, const Eigen::Vector2d& pixel, const Eigen::Vector2d& normalized,
    const Eigen::Matrix2d& pixel_by_normalized) {
  constexpr int kSteps = 2;
  constexpr double kStepPx = 4;
  Eigen::Matrix<double, kBends, kBends> normal = Eigen::Matrix<double, kBends, kBends>::Zero();
  Eigen::Matrix<double, kBends, 2> right = Eigen::Matrix<double, kBends, 2>::Zero();
  for (int y = -kSteps; y <= kSteps; ++y) {
    for (int x = -kSteps; x <= kSteps; ++x) {
      const Eigen::Vector2d offset = kStepPx * Eigen::Vector2d(x, y);
      const auto ray = TryUnproject(camera, pixel + offset);
      if (!ray) return std::nullopt;
      const Eigen::Vector2d linear = pixel_by_normalized * (ray->hnormalized() - normalized);
      const BendTerms terms = TermsOf(Eigen::Vector2d(x, y));
      normal += terms * terms.transpose();
      right += terms * (offset - linear).transpose();
    }
  }
  Eigen::Matrix<double, 2, kBends> bend = normal.ldlt().solve(right).transpose();
  bend.leftCols<3>() /= kStepPx * kStepPx;
  bend.rightCols<4>() /= kStepPx * kStepPx * kStepPx;
  return bend;
}

}  // namespace

PixelFootprint MakePixelFootprint(double blur_px, PixelSampling sampling) {
  const bool fine = sampling == PixelSampling::kFine && blur_px < kSharpPx;
  const Lattice lattice = fine ? kFineLattice : kCoarseLattice;
  PixelFootprint footprint{PixelProfile(blur_px), {}, {}};
  for (int i = 0; i < lattice.points; ++i) {
    const double u = (i + 0.5) / lattice.points;
    const double v = std::fmod((i + 0.5) * lattice.generator / lattice.points, 1.0);
    const Eigen::Vector2d offset(footprint.profile.Quantile(u), footprint.profile.Quantile(v));
    footprint.x.push_back(static_cast<float>(offset.x()));
    footprint.y.push_back(static_cast<float>(offset.y()));
    footprint.reach = std::max(footprint.reach, offset.norm());
  }
  footprint.tail = 0.5 + 3.5 * blur_px;
  return footprint;
}

std::optional<LocalView> MakeLocalView(const Camera& camera, const Pose& camera_from_world,
                                       const CornerPlace& place) {
  const Eigen::Vector3d point = camera_from_world * place.position;
  const std::optional<Eigen::Vector2d> pixel = Project(camera, point);
  if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
  const Eigen::Vector2d normalized = point.hnormalized();
  constexpr double kStep = 1e-5;
  Eigen::Matrix2d pixel_by_normalized;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = Eigen::Vector2d::Unit(i) * kStep;
    const Eigen::Vector2d slope =
        (Distort(camera, normalized + step) - Distort(camera, normalized - step)) / (2 * kStep);
    pixel_by_normalized.col(i) = slope.cwiseProduct(Eigen::Vector2d(camera.fx, camera.fy));
  }
  const Eigen::Matrix2d normalized_by_pixel = pixel_by_normalized.inverse();
  Eigen::Matrix3d normalized_from_offset = Eigen::Matrix3d::Identity();
  normalized_from_offset.topLeftCorner<2, 2>() = normalized_by_pixel;
  normalized_from_offset.topRightCorner<2, 1>() = normalized;
  const Eigen::Vector3d right(1, 0, place.slope.x()), up(0, 1, place.slope.y());
  const Eigen::Vector3d origin =
      place.position - place.printed.x() * right - place.printed.y() * up;
  Eigen::Matrix3d ray_from_board;
  ray_from_board << camera_from_world.rotation * right, camera_from_world.rotation * up,
      camera_from_world * origin;
  LocalView view;
  view.pixel = *pixel;
  const auto bend = LensBend(camera, *pixel, normalized, pixel_by_normalized);
  if (!bend) return std::nullopt;
  view.lens_bend = *bend;
  view.board_from_pixel = ray_from_board.inverse() * normalized_from_offset;
  if (!view.board_from_pixel.allFinite() || !view.lens_bend.allFinite()) return std::nullopt;
  return view;
}

double RenderPixel(const BoardPrint& print, const LocalView& view, const PixelFootprint& footprint,
                   const Eigen::Vector2d& offset) {
  const Eigen::Matrix3d& h = view.board_from_pixel;
  const Eigen::Vector3d p = h * (offset - view.lens_bend * TermsOf(offset)).homogeneous();
  // The third coordinate is the reciprocal depth.
  if (!(p.z() > 0)) return -1;
  const Eigen::Vector2d board = p.hnormalized();
  const Eigen::Matrix2d linear =
      Eigen::Matrix2d::Identity() - view.lens_bend * SlopeOfTerms(offset);
  const Eigen::Matrix2d slope =
      (h.topLeftCorner<2, 2>() - board * h.bottomLeftCorner<1, 2>()) / p.z() * linear;
  const Eigen::Vector2d nearing = (h.bottomLeftCorner<1, 2>() / p.z() * linear).transpose();
  for (const Eigen::Vector2d& o :
       {Eigen::Vector2d(footprint.tail, 0), Eigen::Vector2d(0, footprint.tail)}) {
    if (print.Value(board + slope * o) < 0 || print.Value(board - slope * o) < 0) return -1;
  }
  if (print.UniformRadius(board) > slope.norm() * footprint.reach) return print.Value(board);
  const Eigen::Vector2d across = slope.col(0) + slope.col(1), along = slope.col(0) - slope.col(1);
  const double reach = footprint.tail * std::max(across.norm(), along.norm());
  if (const std::optional<PrintCross> cross = print.CrossNear(board, reach)) {
    return PixelOfCross(*cross, {slope, nearing}, footprint.profile);
  }
  // Perspective moves the middle of what the pixel sees.
  const double variance = 1.0 / 12 + footprint.profile.blur_px() * footprint.profile.blur_px();
  return print.MeanValue(board - variance * slope * nearing, slope, footprint.x, footprint.y);
}

}  // namespace lfm
