// SPDX-License-Identifier: BSD-3-Clause
#include "core/capture.h"

#include <algorithm>

#include "core/camera_json.h"
#include "core/capture_reader.h"
#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr const char* kManifest = "capture.json";

void PutIntrinsics(nlohmann::json& owner, const std::optional<Camera>& camera) {
  if (camera) owner["intrinsics"] = IntrinsicsToJson(*camera);
}

void PutPose(nlohmann::json& owner, const char* key, const std::optional<Pose>& pose) {
  if (pose) owner[key] = PoseToJson(*pose);
}

void PutText(nlohmann::json& owner, const char* key, const std::string& text) {
  if (!text.empty()) owner[key] = text;
}

const char* EncodingName(ColorEncoding encoding) {
  return encoding == ColorEncoding::kLinear ? "linear" : "srgb";
}

const char* SplitName(PhotoSplit split) { return split == PhotoSplit::kTrain ? "train" : "test"; }

nlohmann::json CaptureCameraToJson(const CaptureCamera& camera) {
  nlohmann::json json = {{"width", camera.width}, {"height", camera.height}};
  PutIntrinsics(json, camera.intrinsics);
  if (camera.encoding) json["encoding"] = EncodingName(*camera.encoding);
  return json;
}

nlohmann::json PhotoToJson(const Photo& photo) {
  nlohmann::json json = {{"id", photo.id}, {"file", photo.file}, {"camera", photo.camera}};
  json["split"] = SplitName(photo.split);
  PutPose(json, "camera_from_world", photo.camera_from_world);
  PutText(json, "mask", photo.mask);
  return json;
}

nlohmann::json ScanSetsToJson(const std::vector<ScanSet>& sets) {
  nlohmann::json json = nlohmann::json::array();
  for (const ScanSet& set : sets) {
    nlohmann::json entry = {{"id", set.id}, {"frames", set.frames}};
    PutPose(entry, "camera_from_world", set.camera_from_world);
    json.push_back(std::move(entry));
  }
  return json;
}

nlohmann::json ScannerToJson(const Scanner& scanner) {
  nlohmann::json json = {{"camera", scanner.camera}};
  json["projector"] = {{"width", scanner.projector_width}, {"height", scanner.projector_height}};
  PutIntrinsics(json["projector"], scanner.projector);
  PutPose(json, "projector_from_camera", scanner.projector_from_camera);
  json["scan_roles"] = scanner.scan_roles;
  json["placement_roles"] = scanner.placement_roles;
  json["scans"] = ScanSetsToJson(scanner.scans);
  json["placements"] = ScanSetsToJson(scanner.placements);
  return json;
}

nlohmann::json ReflectanceFieldToJson(const ReflectanceField& field) {
  nlohmann::json json = {{"camera", field.camera}, {"encoding", EncodingName(field.encoding)}};
  PutPose(json, "camera_from_world", field.camera_from_world);
  PutText(json, "mask", field.mask);
  json["pictures"] = nlohmann::json::array();
  for (const LitPicture& picture : field.pictures) {
    const Eigen::Vector3d& d = picture.to_light;
    nlohmann::json entry = {{"file", picture.file},
                            {"direction", {d.x(), d.y(), d.z()}},
                            {"split", SplitName(picture.split)}};
    if (picture.intensity) {
      const Eigen::Vector3d& rgb = *picture.intensity;
      entry["intensity"] = {rgb.x(), rgb.y(), rgb.z()};
    }
    json["pictures"].push_back(std::move(entry));
  }
  return json;
}

nlohmann::json TransportToJson(const TransportField& transport) {
  nlohmann::json json = {{"file", transport.file},
                         {"kind", transport.kind == TransportKind::kImage ? "image" : "mesh"},
                         {"cube_resolution", transport.cube_resolution}};
  PutText(json, "camera", transport.camera);
  PutText(json, "mesh", transport.mesh);
  for (const Eigen::Vector3d& eye : transport.eyes) {
    json["eyes"].push_back({eye.x(), eye.y(), eye.z()});
  }
  return json;
}

}  // namespace

bool Capture::BringsGeometry() const {
  const auto has_intrinsics = [](const auto& entry) { return entry.second.intrinsics.has_value(); };
  const auto has_pose = [](const Photo& photo) { return photo.camera_from_world.has_value(); };
  return !photos.empty() && !mesh.empty() &&
         std::all_of(cameras.begin(), cameras.end(), has_intrinsics) &&
         std::all_of(photos.begin(), photos.end(), has_pose);
}

Capture LoadCapture(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kManifest;
  const nlohmann::json json = ReadJson(file);
  JsonReader root(json, file.string());
  return ReadCaptureManifest(root, folder);
}

void SaveCapture(const Capture& capture) {
  nlohmann::json json = {{"format", kCaptureFormat}, {"version", kCaptureVersion}};
  PutText(json, "name", capture.name);
  PutText(json, "board", capture.board);
  PutText(json, "mesh", capture.mesh);
  json["cameras"] = nlohmann::json::object();
  for (const auto& [key, camera] : capture.cameras) {
    json["cameras"][key] = CaptureCameraToJson(camera);
  }
  json["photos"] = nlohmann::json::array();
  for (const Photo& photo : capture.photos) json["photos"].push_back(PhotoToJson(photo));
  if (capture.scanner) json["scanner"] = ScannerToJson(*capture.scanner);
  if (capture.reflectance_field) {
    json["reflectance_field"] = ReflectanceFieldToJson(*capture.reflectance_field);
  }
  if (capture.transport) json["transport"] = TransportToJson(*capture.transport);
  const std::filesystem::path file = capture.folder / kManifest;
  // What would not load again must not be written.
  JsonReader root(json, file.string());
  ReadCaptureManifest(root, capture.folder);
  WriteJson(json, file);
}

ImageLoader MakeImageLoader(const Capture& capture) {
  std::map<std::string, std::optional<ColorEncoding>> encodings;
  const auto note = [&](const std::string& file, const std::string& camera) {
    const auto found = capture.cameras.find(camera);
    if (found != capture.cameras.end()) encodings[file] = found->second.encoding;
  };
  for (const Photo& photo : capture.photos) note(photo.file, photo.camera);
  if (capture.scanner) {
    for (const auto* sets : {&capture.scanner->scans, &capture.scanner->placements}) {
      for (const ScanSet& set : *sets) {
        for (const std::string& frame : set.frames) note(frame, capture.scanner->camera);
      }
    }
  }
  if (capture.reflectance_field) {
    for (const LitPicture& picture : capture.reflectance_field->pictures) {
      encodings[picture.file] = capture.reflectance_field->encoding;
    }
    encodings[capture.reflectance_field->mask] = capture.reflectance_field->encoding;
  }
  return [folder = capture.folder, encodings = std::move(encodings)](const std::string& file) {
    const std::string problem = CapturePathProblem(folder, file);
    if (!problem.empty()) throw Error((folder / kManifest).string() + ": " + problem);
    const auto encoding = encodings.find(file);
    return ReadImage(folder / file, encoding == encodings.end() ? std::nullopt : encoding->second);
  };
}

}  // namespace lfm
