// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/lens_distortion.h"

namespace lfm {
namespace {

// The radial factor s and 2 ds/d(r2).
struct RadialScale {
  double factor, slope;
};

double Cubic(double a, double b, double c, double r2) { return 1 + r2 * (a + r2 * (b + r2 * c)); }
double CubicSlope(double a, double b, double c, double r2) { return a + r2 * (2 * b + r2 * 3 * c); }

RadialScale RadialScaleAt(const Camera& c, double r2) {
  const double above = Cubic(c.k1, c.k2, c.k3, r2);
  const double above_slope = CubicSlope(c.k1, c.k2, c.k3, r2);
  if (!c.IsRational()) return {above, 2 * above_slope};
  const double below = Cubic(c.k4, c.k5, c.k6, r2);
  const double below_slope = CubicSlope(c.k4, c.k5, c.k6, r2);
  return {above / below, 2 * (above_slope * below - above * below_slope) / (below * below)};
}

// d/dr of r s(r2).
double RadialSlope(const Camera& c, double r2) {
  const RadialScale scale = RadialScaleAt(c, r2);
  return scale.factor + r2 * scale.slope;
}

// The radius may fall between the axis and r although it rises at r itself; so may what is below
// the line pass through zero.
bool RadialRisesUpTo(const Camera& c, double r2) {
  // The slope 1 + 3 k1 r2 + 5 k2 r2^2 + 7 k3 r2^3 without the terms that raise it only falls.
  const auto lowering = [](double k) { return std::min(k, 0.0); };
  const double least =
      1 + r2 * (3 * lowering(c.k1) + r2 * (5 * lowering(c.k2) + r2 * 7 * lowering(c.k3)));
  if (!c.IsRational() && least > 0) return true;
  constexpr int kProbes = 16;
  for (int i = 1; i <= kProbes; ++i) {
    const double probe = r2 * i / kProbes;
    if (!(RadialSlope(c, probe) > 0)) return false;
    if (c.IsRational() && !(Cubic(c.k4, c.k5, c.k6, probe) > 0)) return false;
  }
  return true;
}

Eigen::Matrix2d DistortJacobian(const Camera& c, const Eigen::Vector2d& n) {
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const auto [radial, slope] = RadialScaleAt(c, r2);
  Eigen::Matrix2d j;
  j(0, 0) = radial + x * x * slope + 2 * c.p1 * y + 6 * c.p2 * x;
  j(0, 1) = x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y;
  j(1, 0) = j(0, 1);
  j(1, 1) = radial + y * y * slope + 6 * c.p1 * y + 2 * c.p2 * x;
  return j;
}

}  // namespace

bool Camera::Contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 &&
         pixel.y() < height - 0.5;
}

Eigen::Vector2d Distort(const Camera& c, const Eigen::Vector2d& n) {
  return DistortNormalized(LensTerms<double>{c.k1, c.k2, c.k3, c.p1, c.p2, c.k4, c.k5, c.k6}, n.x(),
                           n.y());
}

std::optional<Eigen::Vector2d> Project(const Camera& camera, const Eigen::Vector3d& point) {
  if (!(point.z() > 0) || !point.allFinite()) return std::nullopt;
  const Eigen::Vector2d normalized = point.head<2>() / point.z();
  if (!normalized.allFinite() || !RadialRisesUpTo(camera, normalized.squaredNorm())) {
    return std::nullopt;
  }
  const Eigen::Vector2d d = Distort(camera, normalized);
  const Eigen::Vector2d pixel(camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy);
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector3d> TryUnproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d distorted((pixel.x() - camera.cx) / camera.fx,
                                  (pixel.y() - camera.cy) / camera.fy);
  if (!distorted.allFinite()) return std::nullopt;
  Eigen::Vector2d n = distorted;
  if (!camera.HasDistortion()) return Eigen::Vector3d(n.x(), n.y(), 1).normalized();
  constexpr int kMaxIterations = 50;
  constexpr double kConverged_rel = 1e-14, kConverged_px = 1e-10;
  const Eigen::Vector2d focal(camera.fx, camera.fy);
  Eigen::Vector2d residual = Distort(camera, n) - distorted;
  for (int i = 0; i < kMaxIterations; ++i) {
    if (residual.norm() <= kConverged_rel * (1 + distorted.norm()) &&
        residual.cwiseProduct(focal).norm() <= kConverged_px) {
      break;
    }
    const Eigen::Vector2d step = DistortJacobian(camera, n).inverse() * residual;
    // Far from the axis a full step can jump over the fold; half a radian is always enough.
    constexpr double kMaxStep = 0.5;
    n -= step.norm() > kMaxStep ? Eigen::Vector2d(step * (kMaxStep / step.norm())) : step;
    if (!n.allFinite()) return std::nullopt;
    residual = Distort(camera, n) - distorted;
  }
  // The second term is what rounding costs far outside any sensor.
  constexpr double kAccepted_px = 5e-10, kAccepted_rel = 1e-15;
  const bool found =
      residual.cwiseProduct(focal).norm() <= std::max(kAccepted_px, kAccepted_rel * pixel.norm()) &&
      RadialRisesUpTo(camera, n.squaredNorm());
  if (!found) return std::nullopt;
  return Eigen::Vector3d(n.x(), n.y(), 1).normalized();
}

Eigen::Vector3d Unproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector3d> direction = TryUnproject(camera, pixel);
  if (direction) return *direction;
  if (!pixel.allFinite()) throw Error("camera: cannot unproject a pixel that is not finite");
  throw Error("camera: the lens model folds over inside the picture at pixel (" +
              std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) +
              "); calibrate again with fewer distortion terms");
}

Camera ScaleCamera(const Camera& camera, double factor) {
  Camera scaled = camera;
  scaled.width = static_cast<int>(std::lround(camera.width * factor));
  scaled.height = static_cast<int>(std::lround(camera.height * factor));
  scaled.fx *= factor;
  scaled.fy *= factor;
  scaled.cx = (camera.cx + 0.5) * factor - 0.5;
  scaled.cy = (camera.cy + 0.5) * factor - 0.5;
  return scaled;
}

void ValidateCamera(const Camera& c, const char* where) {
  const auto fail = [where](const std::string& what) {
    throw Error(std::string(where) + ": camera " + what);
  };
  constexpr int kMaxSide = 65536;
  if (c.width < 1 || c.height < 1 || c.width > kMaxSide || c.height > kMaxSide) {
    fail("size must be between 1 and 65536 pixels, not " + std::to_string(c.width) + " x " +
         std::to_string(c.height));
  }
  for (double value : {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.k3, c.p1, c.p2, c.k4, c.k5, c.k6}) {
    if (!std::isfinite(value)) fail("parameters must be finite numbers");
  }
  if (!(c.fx > 0) || !(c.fy > 0)) fail("focal lengths must be positive");
}

}  // namespace lfm
