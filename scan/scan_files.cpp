// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_files.h"

#include <cctype>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/camera_json.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/ply.h"

namespace lfm {
namespace {

constexpr int kMaxScans = 100000;
constexpr int kMaxSide = 65536;

std::string ScanFileName(size_t index) {
  char name[32];
  std::snprintf(name, sizeof name, "scan_%02zu.ply", index + 1);
  return name;
}

bool IsScanFileName(const std::string& name) {
  if (!name.starts_with("scan_") || !name.ends_with(".ply") || name.size() < 11) return false;
  for (size_t i = 5; i + 4 < name.size(); ++i) {
    if (!std::isdigit(static_cast<unsigned char>(name[i]))) return false;
  }
  return true;
}

/// Clouds of an earlier run with more scans would be taken for this one's.
void RemoveStaleScans(const std::filesystem::path& folder, size_t count) {
  std::error_code ignored;
  std::vector<std::filesystem::path> stale;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!IsScanFileName(name)) continue;
    const std::string digits = name.substr(5, name.size() - 9);
    const bool listed = digits.size() < 9 && static_cast<size_t>(std::stoul(digits)) <= count &&
                        std::stoul(digits) >= 1;
    if (!listed) stale.push_back(entry.path());
  }
  for (const auto& file : stale) std::filesystem::remove(file, ignored);
}

Camera ReadCamera(JsonReader reader) {
  return CameraFromJson(reader, kMaxSide, LensKeys::kRequired);
}

nlohmann::json RigJson(const ScanResult& result) {
  nlohmann::json json;
  json["camera"] = CameraToJson(result.rig.camera);
  json["projector"] = CameraToJson(result.rig.projector);
  json["projector_from_camera"] = PoseToJson(result.rig.projector_from_camera);
  json["camera_rms_px"] = result.rig.camera_rms_px;
  json["projector_rms_px"] = result.rig.projector_rms_px;
  json["condition"] = result.rig.condition;
  json["scans"] = nlohmann::json::array();
  for (const ScanCloud& scan : result.scans) {
    json["scans"].push_back({{"id", scan.id}, {"points", scan.cloud.points.size()}});
  }
  json["rejected"] = nlohmann::json::array();
  for (const ScanFailure& failure : result.rejected) {
    json["rejected"].push_back({{"id", failure.id}, {"reason", failure.reason}});
  }
  return json;
}

double NonNegative(JsonReader& reader, const std::string& key) {
  const double value = reader.Number(key);
  if (value < 0) reader.Fail(key, "must not be negative");
  return value;
}

PointCloud ReadCloud(const std::filesystem::path& file, size_t expected) {
  PointCloud cloud = ReadPlyCloud(file);
  const bool complete =
      cloud.normals.size() == cloud.points.size() && cloud.confidence.size() == cloud.points.size();
  if (cloud.points.size() != expected || !complete) {
    throw Error(file.string() + ": holds " + std::to_string(cloud.points.size()) +
                " points where rig.json says " + std::to_string(expected) +
                " with normals and confidence; run lfm-scan again");
  }
  return cloud;
}

}  // namespace

void SaveScan(const ScanResult& result, const std::filesystem::path& folder) {
  for (size_t i = 0; i < result.scans.size(); ++i) {
    WritePly(result.scans[i].cloud, folder / ScanFileName(i));
  }
  WritePly(result.points, folder / "points.ply");
  WriteJson(RigJson(result), folder / "rig.json");
  RemoveStaleScans(folder, result.scans.size());
}

ScanResult LoadScan(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "rig.json";
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  ScanResult result;
  result.rig.camera = ReadCamera(reader.Object("camera"));
  result.rig.projector = ReadCamera(reader.Object("projector"));
  JsonReader pose = reader.Object("projector_from_camera");
  result.rig.projector_from_camera = PoseFromJson(pose);
  pose.Finish();
  result.rig.camera_rms_px = NonNegative(reader, "camera_rms_px");
  result.rig.projector_rms_px = NonNegative(reader, "projector_rms_px");
  result.rig.condition = NonNegative(reader, "condition");
  size_t total = 0;
  for (JsonReader& scan : reader.Objects("scans")) {
    const std::string id = scan.Text("id");
    const size_t points = static_cast<size_t>(scan.Integer("points", 0, INT32_MAX));
    scan.Finish();
    if (result.scans.size() >= kMaxScans) reader.Fail("scans", "too many");
    result.scans.push_back({id, ReadCloud(folder / ScanFileName(result.scans.size()), points)});
    total += points;
  }
  for (JsonReader& failure : reader.Objects("rejected")) {
    result.rejected.push_back({failure.Text("id"), failure.Text("reason")});
    failure.Finish();
  }
  reader.Finish();
  result.points = ReadCloud(folder / "points.ply", total);
  return result;
}

}  // namespace lfm
