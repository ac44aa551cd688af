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

// Second order of the lens round `normalized`: what moves the pixel at an offset d beyond the
// linear lens, its even part, over x^2, x y, y^2 of d.
Eigen::Matrix<double, 2, 3> LensCurvature(const Camera& camera, const Eigen::Vector2d& normalized,
                                          const Eigen::Matrix2d& normalized_by_pixel) {
  constexpr double kReachPx = 4;
  const Eigen::Vector2d middle = Distort(camera, normalized);
  const auto even = [&](double x, double y) -> Eigen::Vector2d {
    const Eigen::Vector2d step = normalized_by_pixel * Eigen::Vector2d(x, y) * kReachPx;
    const Eigen::Vector2d mean =
        (Distort(camera, normalized + step) + Distort(camera, normalized - step)) / 2;
    return (mean - middle).cwiseProduct(Eigen::Vector2d(camera.fx, camera.fy)) /
           (kReachPx * kReachPx);
  };
  Eigen::Matrix<double, 2, 3> curvature;
  curvature.col(0) = even(1, 0);
  curvature.col(2) = even(0, 1);
  curvature.col(1) = even(1, 1) - curvature.col(0) - curvature.col(2);
  return curvature;
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
  view.lens_curvature = LensCurvature(camera, normalized, normalized_by_pixel);
  view.board_from_pixel = ray_from_board.inverse() * normalized_from_offset;
  if (!view.board_from_pixel.allFinite() || !view.lens_curvature.allFinite()) return std::nullopt;
  return view;
}

double RenderPixel(const BoardPrint& print, const LocalView& view, const PixelFootprint& footprint,
                   const Eigen::Vector2d& offset) {
  const Eigen::Matrix3d& h = view.board_from_pixel;
  const Eigen::Vector3d squares(offset.x() * offset.x(), offset.x() * offset.y(),
                                offset.y() * offset.y());
  const Eigen::Vector3d p = h * (offset - view.lens_curvature * squares).homogeneous();
  // The third coordinate is the reciprocal depth.
  if (!(p.z() > 0)) return -1;
  const Eigen::Vector2d board = p.hnormalized();
  const Eigen::Matrix2d slope =
      (h.topLeftCorner<2, 2>() - board * h.bottomLeftCorner<1, 2>()) / p.z();
  for (const Eigen::Vector2d& o :
       {Eigen::Vector2d(footprint.tail, 0), Eigen::Vector2d(0, footprint.tail)}) {
    if (print.Value(board + slope * o) < 0 || print.Value(board - slope * o) < 0) return -1;
  }
  if (print.UniformRadius(board) > slope.norm() * footprint.reach) return print.Value(board);
  const Eigen::Vector2d across = slope.col(0) + slope.col(1), along = slope.col(0) - slope.col(1);
  const double reach = footprint.tail * std::max(across.norm(), along.norm());
  if (const std::optional<PrintCross> cross = print.CrossNear(board, reach)) {
    return PixelOfCross(*cross, slope, footprint.profile);
  }
  return print.MeanValue(board, slope, footprint.x, footprint.y);
}

}  // namespace lfm
