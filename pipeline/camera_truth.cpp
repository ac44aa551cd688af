// SPDX-License-Identifier: BSD-3-Clause
// Cameras and poses against the truth.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/error.h"
#include "pipeline/truth.h"

namespace lfm {
namespace {

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct PosePair {
  const PosedImage* found;
  Pose truth;
};

std::vector<PosePair> PairPoses(const CalibResult& calib, const GroundTruth& truth) {
  std::map<std::string, Pose> poses;
  for (const Photo& photo : truth.capture.photos) {
    if (photo.camera_from_world) poses[photo.id] = *photo.camera_from_world;
  }
  std::vector<PosePair> pairs;
  for (const PosedImage& photo : calib.photos) {
    const auto true_pose = poses.find(photo.id);
    if (true_pose != poses.end()) pairs.push_back({&photo, true_pose->second});
  }
  if (pairs.empty()) throw Error("ground truth: has no pose of any calibrated photograph");
  return pairs;
}

// Errors of the cameras that took pictures, each beside the true camera of the same picture.
IntrinsicsErrors CompareCameras(const CalibResult& calib, const GroundTruth& truth,
                                const std::set<std::pair<std::string, std::string>>& names) {
  IntrinsicsErrors errors;
  for (const auto& [found_name, true_name] : names) {
    const auto found = calib.cameras.find(found_name);
    const auto known = truth.capture.cameras.find(true_name);
    if (found == calib.cameras.end() || known == truth.capture.cameras.end()) continue;
    if (!known->second.intrinsics) continue;
    const Camera &a = found->second, &b = *known->second.intrinsics;
    errors.focal_percent = std::max(
        {errors.focal_percent, 100 * std::abs(a.fx / b.fx - 1), 100 * std::abs(a.fy / b.fy - 1)});
    errors.principal_point_px =
        std::max(errors.principal_point_px, std::hypot(a.cx - b.cx, a.cy - b.cy));
    ++errors.cameras;
  }
  return errors;
}

}  // namespace

PoseErrors MeasurePoses(const CalibResult& calib, const GroundTruth& truth) {
  std::vector<double> mm, deg;
  for (const auto& [photo, pose] : PairPoses(calib, truth)) {
    mm.push_back((photo->camera_from_world.Center() - pose.Center()).norm());
    deg.push_back(RotationAngle(photo->camera_from_world.rotation, pose.rotation) * 180 /
                  std::numbers::pi);
  }
  return {Median(mm), Median(deg), *std::max_element(mm.begin(), mm.end()),
          *std::max_element(deg.begin(), deg.end()), static_cast<int>(mm.size())};
}

AlignedPoseErrors MeasureAlignedPoses(const CalibResult& calib, const GroundTruth& truth) {
  constexpr size_t kLeastPoses = 3;
  const std::vector<PosePair> pairs = PairPoses(calib, truth);
  if (pairs.size() < kLeastPoses) return {MeasurePoses(calib, truth).median_mm, 0};
  Eigen::Matrix3Xd found(3, pairs.size()), known(3, pairs.size());
  for (size_t i = 0; i < pairs.size(); ++i) {
    found.col(static_cast<Eigen::Index>(i)) = pairs[i].found->camera_from_world.Center();
    known.col(static_cast<Eigen::Index>(i)) = pairs[i].truth.Center();
  }
  const Eigen::Matrix4d known_from_found = Eigen::umeyama(found, known, true);
  std::vector<double> mm;
  for (Eigen::Index i = 0; i < found.cols(); ++i) {
    const Eigen::Vector4d moved = known_from_found * found.col(i).homogeneous();
    mm.push_back((moved.head<3>() - known.col(i)).norm());
  }
  const double scale = std::cbrt(known_from_found.topLeftCorner<3, 3>().determinant());
  return {Median(mm), 100 * (1 / scale - 1)};
}

double MeasurePoseHonesty(const CalibResult& calib, const GroundTruth& truth) {
  double sum = 0;
  int count = 0;
  for (const auto& [photo, pose] : PairPoses(calib, truth)) {
    const Eigen::LDLT<Eigen::MatrixXd> covariance(photo->covariance);
    if (photo->covariance.isZero(0) || !covariance.isPositive()) continue;
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(photo->camera_from_world.rotation * pose.rotation.transpose()));
    Eigen::Matrix<double, 6, 1> error;
    error << turn.angle() * turn.axis(), photo->camera_from_world.translation - pose.translation;
    sum += error.dot(covariance.solve(error)) / 6;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

IntrinsicsErrors MeasurePhotoIntrinsics(const CalibResult& calib, const GroundTruth& truth) {
  std::map<std::string, std::string> camera_of;
  for (const Photo& photo : truth.capture.photos) camera_of[photo.id] = photo.camera;
  std::set<std::pair<std::string, std::string>> names;
  for (const PosedImage& photo : calib.photos) {
    if (camera_of.contains(photo.id)) names.insert({photo.camera, camera_of.at(photo.id)});
  }
  return CompareCameras(calib, truth, names);
}

IntrinsicsErrors MeasureScannerIntrinsics(const CalibResult& calib, const GroundTruth& truth) {
  std::set<std::pair<std::string, std::string>> names;
  for (const PosedImage& scan : calib.scans) {
    if (truth.capture.scanner) names.insert({scan.camera, truth.capture.scanner->camera});
  }
  return CompareCameras(calib, truth, names);
}

}  // namespace lfm
