// SPDX-License-Identifier: BSD-3-Clause
#include "calib/camera_start.h"

#include <algorithm>

#include "calib/bundle_adjustment.h"
#include "calib/pose_estimation.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr size_t kMinPictures = 3;
constexpr double kUsualFocalInWidths = 1.2;
// Detected tag corners are off by half a pixel, and by more before the lens is known.
constexpr double kLensUnknownScalePx = 4.0;
constexpr double kDetectionScalePx = 1.0;

bool Selected(const CalibPicture& picture, const std::string& camera_name, PhotoSplit split) {
  return picture.InUse() && picture.camera == camera_name && picture.split == split;
}

std::vector<Eigen::Vector3d> OnPlate(const std::vector<Eigen::Vector2d>& points_mm) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : points_mm) points.emplace_back(p.x(), p.y(), 0.0);
  return points;
}

BundleView ViewOfTags(const CalibPicture& picture) {
  return {picture.camera_from_world, picture.match.world_points, picture.match.world_pixels};
}

Camera AdjustToTags(const Camera& camera, std::vector<CalibPicture>& pictures,
                    const std::string& camera_name, const BundleOptions& options) {
  std::vector<BundleView> views;
  const std::vector<size_t> selected = SelectPictures(pictures, camera_name, PhotoSplit::kTrain);
  for (const size_t i : selected) views.push_back(ViewOfTags(pictures[i]));
  const BundleResult result = AdjustBundle(camera, views, options);
  for (size_t v = 0; v < selected.size(); ++v) {
    pictures[selected[v]].camera_from_world = result.poses[v];
  }
  return result.camera;
}

}  // namespace

std::vector<size_t> SelectPictures(const std::vector<CalibPicture>& pictures,
                                   const std::string& camera_name, PhotoSplit split) {
  std::vector<size_t> selected;
  for (size_t i = 0; i < pictures.size(); ++i) {
    if (Selected(pictures[i], camera_name, split)) selected.push_back(i);
  }
  return selected;
}

void RequireEnough(const std::vector<CalibPicture>& pictures, const std::string& camera_name) {
  const size_t in_use = SelectPictures(pictures, camera_name, PhotoSplit::kTrain).size();
  if (in_use >= kMinPictures) return;
  std::string first;
  for (const CalibPicture& picture : pictures) {
    if (picture.camera == camera_name && !picture.InUse() && first.empty()) {
      first = "; set aside, for example: " + picture.file + ": " + picture.rejected;
    }
  }
  throw Error("camera \"" + camera_name + "\": " + std::to_string(in_use) +
              " usable training picture" + (in_use == 1 ? "" : "s") +
              " of the platform; at least three are needed, from different directions" + first);
}

std::vector<CalibPicture> StartPoses(std::vector<CalibPicture> pictures,
                                     const std::string& camera_name, PhotoSplit split,
                                     const Camera& camera) {
  for (const size_t i : SelectPictures(pictures, camera_name, split)) {
    CalibPicture& picture = pictures[i];
    const std::optional<Pose> pose = EstimatePlanarPose(camera, OnPlate(picture.match.points_mm),
                                                        picture.match.pixels, kDetectionScalePx);
    if (pose) {
      picture.camera_from_world = *pose * picture.match.world_from_plate.Inverse();
    } else {
      picture.rejected = "no pose explains its tags";
    }
  }
  return pictures;
}

CameraStart StartCamera(std::vector<CalibPicture> pictures, const std::string& camera_name,
                        int width, int height, const std::optional<Camera>& known) {
  if (known) {
    return {*known, StartPoses(std::move(pictures), camera_name, PhotoSplit::kTrain, *known)};
  }
  RequireEnough(pictures, camera_name);
  std::vector<Eigen::Matrix3d> homographies;
  for (const size_t i : SelectPictures(pictures, camera_name, PhotoSplit::kTrain)) {
    homographies.push_back(pictures[i].match.pixel_from_board);
  }
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = FocalFromHomographies(homographies, width, height)
                              .value_or(kUsualFocalInWidths * std::max(width, height));
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  pictures = StartPoses(std::move(pictures), camera_name, PhotoSplit::kTrain, camera);
  RequireEnough(pictures, camera_name);
  camera = AdjustToTags(
      camera, pictures, camera_name,
      {.free = FreeIntrinsics::kFocalAndRadial, .robust_scale_px = kLensUnknownScalePx});
  // With a lens, the other one of the two planar poses may turn out to be the right one.
  pictures = StartPoses(std::move(pictures), camera_name, PhotoSplit::kTrain, camera);
  RequireEnough(pictures, camera_name);
  camera = AdjustToTags(camera, pictures, camera_name, {.robust_scale_px = kDetectionScalePx});
  return {camera, std::move(pictures)};
}

}  // namespace lfm
