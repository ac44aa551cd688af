// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/camera_file.h"

#include "calib/calib_files.h"
#include "core/camera_json.h"
#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr int kMaxSide = 16384;

}  // namespace

PosedCamera ReadCameraFile(const std::filesystem::path& file) {
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  JsonReader intrinsics = reader.Object("camera");
  PosedCamera posed;
  posed.camera = CameraFromJson(intrinsics, kMaxSide, LensKeys::kOptional);
  JsonReader pose = reader.Object("camera_from_world");
  posed.camera_from_world = PoseFromJson(pose);
  reader.Finish();
  return posed;
}

void WriteCameraFile(const PosedCamera& posed, const std::filesystem::path& file) {
  WriteJson({{"camera", CameraToJson(posed.camera)},
             {"camera_from_world", PoseToJson(posed.camera_from_world)}},
            file);
}

std::map<std::string, PosedCamera> PhotoCameras(const std::filesystem::path& work) {
  const CalibResult calib = LoadCalib(work / "calib");
  std::map<std::string, PosedCamera> cameras;
  for (const PosedImage& photo : calib.photos) {
    cameras[photo.id] = {calib.cameras.at(photo.camera), photo.camera_from_world};
  }
  if (cameras.empty()) {
    throw Error((work / "calib" / "poses.json").string() + ": no photograph has a pose");
  }
  return cameras;
}

PosedCamera PhotoCamera(const std::filesystem::path& work, const std::string& photo_id) {
  const CalibResult calib = LoadCalib(work / "calib");
  for (const PosedImage& photo : calib.photos) {
    if (photo.id == photo_id) return {calib.cameras.at(photo.camera), photo.camera_from_world};
  }
  const std::string known =
      calib.photos.empty() ? "it has none"
                           : "it has " + calib.photos.front().id + " to " + calib.photos.back().id;
  throw Error("photograph '" + photo_id + "' has no pose in " +
              (work / "calib" / "poses.json").string() + "; " + known);
}

}  // namespace lfm
