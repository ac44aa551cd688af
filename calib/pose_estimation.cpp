// SPDX-License-Identifier: BSD-3-Clause
#include "calib/pose_estimation.h"

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "calib/homography.h"

namespace lfm {
namespace {

double CauchyCost(const Camera& camera, const BundleView& view, double scale_px) {
  double cost = 0;
  for (const auto& error : ReprojectionErrors(camera, view)) {
    if (!error) return std::numeric_limits<double>::infinity();
    cost += std::log1p(error->squaredNorm() / (scale_px * scale_px));
  }
  return cost;
}

Pose PoseFromOpenCv(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  const Eigen::Vector3d w(rotation_vector.at<double>(0), rotation_vector.at<double>(1),
                          rotation_vector.at<double>(2));
  const double angle = w.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(w / angle) : Eigen::Vector3d::UnitX();
  return Pose::FromQuaternion(
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)),
      {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)});
}

std::vector<Pose> PlanarPoseCandidates(const std::vector<Eigen::Vector3d>& points,
                                       const std::vector<Eigen::Vector2d>& normalized) {
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (size_t i = 0; i < points.size(); ++i) {
    object.emplace_back(points[i].x(), points[i].y(), points[i].z());
    image.emplace_back(normalized[i].x(), normalized[i].y());
  }
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations,
                      translations, false, cv::SOLVEPNP_IPPE);
  std::vector<Pose> poses;
  for (size_t i = 0; i < rotations.size(); ++i) {
    poses.push_back(PoseFromOpenCv(rotations[i], translations[i]));
  }
  return poses;
}

}  // namespace

std::optional<double> FocalFromHomographies(const std::vector<Eigen::Matrix3d>& pixel_from_plane,
                                            int width, int height) {
  const double unit = std::max(width, height);
  Eigen::Matrix3d to_unit;
  to_unit << 1 / unit, 0, -(width - 1) / 2.0 / unit, 0, 1 / unit, -(height - 1) / 2.0 / unit, 0, 0,
      1;
  double ab = 0, aa = 0;
  for (const Eigen::Matrix3d& pixel_homography : pixel_from_plane) {
    const Eigen::Matrix3d h = to_unit * pixel_homography;
    const Eigen::Vector3d h1 = h.col(0), h2 = h.col(1);
    const double scale = h1.squaredNorm() + h2.squaredNorm();
    if (!(scale > 0) || !std::isfinite(scale)) continue;
    // a w + b = 0 with w = 1 / f^2.
    const double a1 = (h1(0) * h2(0) + h1(1) * h2(1)) / scale, b1 = h1(2) * h2(2) / scale;
    const double a2 = (h1.head<2>().squaredNorm() - h2.head<2>().squaredNorm()) / scale;
    const double b2 = (h1(2) * h1(2) - h2(2) * h2(2)) / scale;
    ab += a1 * b1 + a2 * b2;
    aa += a1 * a1 + a2 * a2;
  }
  const double w = -ab / aa;
  if (!(w > 0) || !std::isfinite(w)) return std::nullopt;
  const double focal_in_widths = 1 / std::sqrt(w);
  if (focal_in_widths < 0.2 || focal_in_widths > 50) return std::nullopt;
  return focal_in_widths * unit;
}

std::optional<Pose> EstimatePlanarPose(const Camera& camera,
                                       const std::vector<Eigen::Vector3d>& points,
                                       const std::vector<Eigen::Vector2d>& pixels,
                                       double robust_scale_px) {
  if (points.size() < 4 || points.size() != pixels.size()) return std::nullopt;
  std::vector<Eigen::Vector2d> plane, normalized;
  for (size_t i = 0; i < points.size(); ++i) {
    plane.push_back(points[i].head<2>());
    const std::optional<Eigen::Vector3d> direction = TryUnproject(camera, pixels[i]);
    if (!direction) return std::nullopt;
    normalized.push_back(direction->hnormalized());
  }
  if (!FitHomography(plane, normalized)) return std::nullopt;
  std::optional<Pose> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const Pose& candidate : PlanarPoseCandidates(points, normalized)) {
    if (!candidate.rotation.allFinite() || !candidate.translation.allFinite()) continue;
    BundleView view = {candidate, points, pixels};
    view.camera_from_world = AdjustPose(camera, view, robust_scale_px);
    const double cost = CauchyCost(camera, view, robust_scale_px);
    // The print is seen from above only.
    if (cost < best_cost && view.camera_from_world.Center().z() > 0) {
      best_cost = cost;
      best = view.camera_from_world;
    }
  }
  return best;
}

}  // namespace lfm
