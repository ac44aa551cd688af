// SPDX-License-Identifier: BSD-3-Clause
#include "scan/triangulate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/pixel_directions.h"

namespace lfm {
namespace {

constexpr int kLensIterations = 50;
constexpr int kRadius = 2;
constexpr int kWindow = (2 * kRadius + 1) * (2 * kRadius + 1);
constexpr int kMinConnected = 6;
// Steeper steps from pixel to pixel are taken for depth edges.
constexpr double kSteepestDeg = 87;
constexpr int kMinFit = 6;
constexpr int kReweightings = 3;
constexpr double kSmallestSigmaMm = 1e-4;
constexpr double kGoodSigmaMm = 0.15;  // an expected error of this size halves the confidence

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// One pixel's neighbour as the plane fit sees it.
struct Sample {
  Eigen::Vector2d offset;  ///< ray minus the centre's ray
  double inverse_depth = 0;
  double weight = 1;
};

/// inverse depth = center + slope . (ray - centre's ray)
struct AffineFit {
  double center = 0;
  Eigen::Vector2d slope = {0, 0};
  double roughness = 0;  ///< weighted RMS of the residuals, in inverse depth
};

std::optional<AffineFit> SolveAffine(const std::array<Sample, kWindow>& samples, int count) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = 0; i < count; ++i) {
    const Sample& s = samples[static_cast<size_t>(i)];
    const Eigen::Vector3d basis(1, s.offset.x(), s.offset.y());
    normal += s.weight * basis * basis.transpose();
    right += s.weight * s.inverse_depth * basis;
  }
  const Eigen::LDLT<Eigen::Matrix3d> factor(normal);
  const double largest = factor.vectorD().maxCoeff();
  if (!factor.isPositive() || !(factor.vectorD().minCoeff() > 1e-14 * largest)) return std::nullopt;
  const Eigen::Vector3d solution = factor.solve(right);
  if (!solution.allFinite()) return std::nullopt;
  AffineFit fit{solution(0), solution.tail<2>(), 0};
  double sum = 0, weights = 0;
  for (int i = 0; i < count; ++i) {
    const Sample& s = samples[static_cast<size_t>(i)];
    const double r = s.inverse_depth - fit.center - fit.slope.dot(s.offset);
    sum += s.weight * r * r;
    weights += s.weight;
  }
  fit.roughness = std::sqrt(sum / std::max(weights, 1e-300));
  return fit;
}

/// Raw depths of one scan and what Triangulate needs beside them.
class Neighbourhood {
 public:
  Neighbourhood(const std::vector<Eigen::Vector2d>& rays, const std::vector<double>& depth,
                int width, int height, const ScanOptions& options)
      : rays_(rays), depth_(depth), width_(width), height_(height), options_(options) {
    steepest_ = std::tan(Radians(std::min(options.max_grazing_deg, kSteepestDeg)));
  }

  /// The two depths may belong to one surface seen at no more than the grazing limit, or
  /// kSteepestDeg where that is less.
  bool Connected(size_t a, size_t b) const {
    if (depth_[a] <= 0 || depth_[b] <= 0) return false;
    const double across = (rays_[a] - rays_[b]).norm() * std::min(depth_[a], depth_[b]);
    return std::abs(depth_[a] - depth_[b]) <= across * steepest_ + options_.max_ray_gap_mm;
  }

  std::optional<AffineFit> Fit(int x, int y) const {
    const size_t center = Index(x, y);
    std::array<Sample, kWindow> samples;
    int count = 0, adjacent = 0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        if (!Inside(x + dx, y + dy)) continue;
        const size_t p = Index(x + dx, y + dy);
        if (!Connected(center, p)) continue;
        if (p != center && std::max(std::abs(dx), std::abs(dy)) == 1) ++adjacent;
        samples[static_cast<size_t>(count++)] = {rays_[p] - rays_[center], 1 / depth_[p], 1};
      }
    }
    if (adjacent < kMinConnected || count < kMinFit) return std::nullopt;
    std::optional<AffineFit> fit = SolveAffine(samples, count);
    for (int round = 0; fit && round < kReweightings; ++round) {
      // In inverse depth, a gap g at depth Z is g / Z^2.
      const double scale = options_.max_ray_gap_mm / (depth_[center] * depth_[center]) / 3;
      for (int i = 0; i < count; ++i) {
        Sample& s = samples[static_cast<size_t>(i)];
        const double r = (s.inverse_depth - fit->center - fit->slope.dot(s.offset)) / scale;
        s.weight = 1 / ((1 + r * r) * (1 + r * r));
      }
      fit = SolveAffine(samples, count);
    }
    return fit;
  }

 private:
  bool Inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * width_ + x; }

  const std::vector<Eigen::Vector2d>& rays_;
  const std::vector<double>& depth_;
  int width_, height_;
  const ScanOptions& options_;
  double steepest_ = 0;
};

/// Standard deviation of the depth (mm) for one of the column (px).
double DepthPerColumn(const RigCalibration& rig, const Eigen::Vector2d& ray, double column,
                      double depth) {
  constexpr double kStepPx = 0.01;
  const std::optional<double> moved = DepthFromColumn(rig, ray, column + kStepPx);
  return moved ? std::abs(*moved - depth) / kStepPx : 1e9;
}

struct PixelVerdict {
  Eigen::Vector3f normal = {0, 0, 0};
  float confidence = 0;
  double seen = 0;      ///< cosine between normal and line of sight
  double rough_mm = 0;  ///< RMS of the neighbourhood about its plane, or the pixel's own distance
};

PixelVerdict Judge(const Eigen::Vector3d& projector_center, const Eigen::Vector2d& ray,
                   double depth, const AffineFit& fit, double sigma_mm, double decoding,
                   const ScanOptions& options) {
  PixelVerdict verdict;
  // 1 / Z = slope . ray + (center - slope . centre's ray) is the plane m . X = 1.
  Eigen::Vector3d normal(-fit.slope.x(), -fit.slope.y(), fit.slope.dot(ray) - fit.center);
  if (!(normal.norm() > 0)) return verdict;
  normal.normalize();
  const Eigen::Vector3d point = depth * ray.homogeneous();
  const double seen = normal.dot(-point.normalized());
  const double lit = normal.dot((projector_center - point).normalized());
  const double limit = std::cos(Radians(options.max_grazing_deg));
  if (!(seen >= limit) || !(lit >= limit)) return verdict;
  // An error along the ray moves the surface by its part along the normal.
  const double mm_per_inverse = depth * depth * seen;
  const double gap = std::abs(1 / depth - fit.center) * mm_per_inverse;
  if (!(gap <= options.max_ray_gap_mm)) return verdict;
  const double rough = fit.roughness * mm_per_inverse;
  const double expected = std::hypot(sigma_mm * seen, rough, gap) / kGoodSigmaMm;
  const double confidence = decoding * std::sqrt(std::min(seen, lit)) / (1 + expected * expected);
  if (!(confidence >= options.min_confidence)) return verdict;
  verdict.seen = seen;
  verdict.rough_mm = std::max(rough, gap);
  verdict.normal = normal.cast<float>();
  verdict.confidence = static_cast<float>(std::min(1.0, confidence));
  return verdict;
}

}  // namespace

std::vector<Eigen::Vector2d> NormalizedRays(const Camera& camera) {
  const std::vector<Eigen::Vector3d> directions = PixelDirections(camera);
  std::vector<Eigen::Vector2d> rays(directions.size());
  for (size_t p = 0; p < rays.size(); ++p) {
    // Zero by zero where the lens folds: not a number.
    rays[p] = directions[p].hnormalized();
  }
  return rays;
}

std::optional<double> DepthFromColumn(const RigCalibration& rig, const Eigen::Vector2d& ray,
                                      double column) {
  const Camera& projector = rig.projector;
  const Pose& pose = rig.projector_from_camera;
  const Eigen::Vector3d direction = pose.rotation * ray.homogeneous();
  const double target = (column - projector.cx) / projector.fx;
  double undistorted = target, depth = 0;
  bool settled = false;
  for (int i = 0; i < kLensIterations && !settled; ++i) {
    // (direction.x Z + t.x) = undistorted (direction.z Z + t.z)
    const double divisor = direction.x() - undistorted * direction.z();
    const double above = undistorted * pose.translation.z() - pose.translation.x();
    if (!(std::abs(divisor) > 1e-12)) return std::nullopt;
    depth = above / divisor;
    const Eigen::Vector3d point = depth * direction + pose.translation;
    if (!(depth > 0) || !(point.z() > 0) || !std::isfinite(depth)) return std::nullopt;
    if (!projector.HasDistortion()) break;
    const Eigen::Vector2d pinhole(undistorted, point.y() / point.z());
    const double next = target - (Distort(projector, pinhole).x() - undistorted);
    settled = std::abs(next - undistorted) < 1e-12;
    undistorted = next;
  }
  if (projector.HasDistortion() && !settled) return std::nullopt;
  const std::optional<Eigen::Vector2d> pixel =
      Project(projector, depth * direction + pose.translation);
  if (!pixel || !projector.Contains(*pixel)) return std::nullopt;
  return depth;
}

RangeMap Triangulate(const RigCalibration& rig, const std::vector<Eigen::Vector2d>& rays,
                     const DecodedPixels& decoded, const ScanOptions& options,
                     const RigUncertainty& uncertainty) {
  const size_t pixels = rays.size();
  if (decoded.width != rig.camera.width || decoded.height != rig.camera.height ||
      decoded.column.position.size() != pixels) {
    throw Error("the scan's pictures have " + std::to_string(decoded.width) + " x " +
                std::to_string(decoded.height) + " pixels, the calibrated scanner " +
                std::to_string(rig.camera.width) + " x " + std::to_string(rig.camera.height) +
                "; use the pictures that the calibration saw");
  }
  std::vector<double> depth(pixels, 0);
  for (size_t p = 0; p < pixels; ++p) {
    if (decoded.column.confidence[p] <= 0 || !rays[p].allFinite()) continue;
    depth[p] = DepthFromColumn(rig, rays[p], decoded.column.position[p]).value_or(0);
  }
  RangeMap map;
  map.width = decoded.width;
  map.height = decoded.height;
  map.depth.assign(pixels, 0);
  map.normal.assign(pixels, Eigen::Vector3f::Zero());
  map.confidence.assign(pixels, 0);
  map.sigma_mm.assign(pixels, 0);
  const Neighbourhood neighbourhood(rays, depth, map.width, map.height, options);
  const Eigen::Vector3d projector_center = rig.projector_from_camera.Center();
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const size_t p = static_cast<size_t>(y) * map.width + x;
      if (depth[p] <= 0) continue;
      const std::optional<AffineFit> fit = neighbourhood.Fit(x, y);
      if (!fit) continue;
      const double mm_per_px = DepthPerColumn(rig, rays[p], decoded.column.position[p], depth[p]);
      const double sigma_mm = decoded.column.sigma[p] * mm_per_px;
      const PixelVerdict verdict = Judge(projector_center, rays[p], depth[p], *fit, sigma_mm,
                                         decoded.column.confidence[p], options);
      if (verdict.confidence <= 0) continue;
      map.depth[p] = depth[p];
      map.normal[p] = verdict.normal;
      map.confidence[p] = verdict.confidence;
      const double rig_px = ColumnSigmaPx(rig, uncertainty, depth[p] * rays[p].homogeneous());
      // What moves single pixels beside noise (light that differs within them) shows in the
      // neighbourhood's roughness.
      const double noise_mm = std::max(sigma_mm * verdict.seen, verdict.rough_mm);
      const double across = std::hypot(noise_mm, rig_px * mm_per_px * verdict.seen);
      map.sigma_mm[p] = static_cast<float>(std::max(kSmallestSigmaMm, across));
    }
  }
  return map;
}

}  // namespace lfm
