// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/camera_file.h"

#include "calib/calib_files.h"
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
  Camera& camera = posed.camera;
  camera.width = intrinsics.Integer("width", 1, kMaxSide);
  camera.height = intrinsics.Integer("height", 1, kMaxSide);
  camera.fx = intrinsics.Number("fx");
  camera.fy = intrinsics.Number("fy");
  camera.cx = intrinsics.Number("cx");
  camera.cy = intrinsics.Number("cy");
  camera.k1 = intrinsics.NumberOr("k1", 0);
  camera.k2 = intrinsics.NumberOr("k2", 0);
  camera.k3 = intrinsics.NumberOr("k3", 0);
  camera.p1 = intrinsics.NumberOr("p1", 0);
  camera.p2 = intrinsics.NumberOr("p2", 0);
  intrinsics.Finish();
  JsonReader pose = reader.Object("camera_from_world");
  posed.camera_from_world = PoseFromJson(pose);
  reader.Finish();
  ValidateCamera(camera, file.string().c_str());
  return posed;
}

void WriteCameraFile(const PosedCamera& posed, const std::filesystem::path& file) {
  const Camera& camera = posed.camera;
  nlohmann::json intrinsics = {{"width", camera.width}, {"height", camera.height},
                               {"fx", camera.fx},       {"fy", camera.fy},
                               {"cx", camera.cx},       {"cy", camera.cy}};
  if (camera.HasDistortion()) {
    intrinsics.update({{"k1", camera.k1},
                       {"k2", camera.k2},
                       {"k3", camera.k3},
                       {"p1", camera.p1},
                       {"p2", camera.p2}});
  }
  WriteJson({{"camera", intrinsics}, {"camera_from_world", PoseToJson(posed.camera_from_world)}},
            file);
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
