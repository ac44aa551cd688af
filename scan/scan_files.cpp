// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_files.h"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "core/atomic_file.h"
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

/// In a file that people write, lens terms that are 0 may be left out.
Camera ReadKnownCamera(JsonReader reader) {
  return CameraFromJson(reader, kMaxSide, LensKeys::kOptional);
}

nlohmann::json Triple(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json ToJson(const TurntableReport& t) {
  return {{"scans", t.scans},
          {"direction", Triple(t.direction)},
          {"point", Triple(t.point)},
          {"rms_mm", t.rms_mm},
          {"chi2_per_dof", t.chi2_per_dof}};
}

nlohmann::json ToJson(const RegistrationReport& r) {
  return {{"kept", r.kept},
          {"pairs", r.pairs},
          {"correspondences", r.correspondences},
          {"held_out", r.held_out},
          {"before_mm", r.before_mm},
          {"after_mm", r.after_mm},
          {"largest_shift_mm", r.largest_shift_mm}};
}

nlohmann::json RigJson(const ScanResult& result) {
  nlohmann::json json;
  json["camera"] = CameraToJson(result.rig.camera);
  json["projector"] = CameraToJson(result.rig.projector);
  json["projector_from_camera"] = PoseToJson(result.rig.projector_from_camera);
  json["camera_rms_px"] = result.rig.camera_rms_px;
  json["projector_rms_px"] = result.rig.projector_rms_px;
  json["condition"] = result.rig.condition;
  json["projector_terms"] = result.rig.projector_terms;
  json["raster_gain"] = result.rig.raster_gain;
  json["source"] = result.rig.source == RigSource::kGiven ? "given" : "placements";
  json["turntables"] = nlohmann::json::array();
  for (const TurntableReport& t : result.turntables) json["turntables"].push_back(ToJson(t));
  json["registration"] = ToJson(result.registration);
  json["scans"] = nlohmann::json::array();
  for (const ScanCloud& scan : result.scans) {
    json["scans"].push_back({{"id", scan.id},
                             {"points", scan.cloud.points.size()},
                             {"camera_from_world", PoseToJson(scan.camera_from_world)}});
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

Eigen::Vector3d ReadTriple(JsonReader& reader, const std::string& key) {
  const std::vector<double> v = reader.Numbers(key, 3);
  return {v[0], v[1], v[2]};
}

TurntableReport ReadTurntable(JsonReader& reader) {
  TurntableReport t;
  t.scans = reader.Texts("scans");
  t.direction = ReadTriple(reader, "direction");
  t.point = ReadTriple(reader, "point");
  t.rms_mm = NonNegative(reader, "rms_mm");
  t.chi2_per_dof = NonNegative(reader, "chi2_per_dof");
  reader.Finish();
  return t;
}

RegistrationReport ReadRegistration(JsonReader reader) {
  RegistrationReport r;
  r.kept = reader.Bool("kept");
  r.pairs = reader.Integer("pairs", 0, INT32_MAX);
  r.correspondences = reader.Integer("correspondences", 0, INT32_MAX);
  r.held_out = reader.Integer("held_out", 0, INT32_MAX);
  r.before_mm = NonNegative(reader, "before_mm");
  r.after_mm = NonNegative(reader, "after_mm");
  r.largest_shift_mm = NonNegative(reader, "largest_shift_mm");
  reader.Finish();
  return r;
}

RigSource ReadSource(JsonReader& reader) {
  const std::string source = reader.Text("source");
  if (source != "placements" && source != "given") {
    reader.Fail("source", "expected \"placements\" or \"given\"");
  }
  return source == "given" ? RigSource::kGiven : RigSource::kPlacements;
}

PointCloud ReadCloud(const std::filesystem::path& file, size_t expected) {
  PointCloud cloud = ReadPlyCloud(file);
  const bool complete = cloud.normals.size() == cloud.points.size() &&
                        cloud.confidence.size() == cloud.points.size() &&
                        cloud.sigma_mm.size() == cloud.points.size();
  if (cloud.points.size() != expected || !complete) {
    throw Error(file.string() + ": holds " + std::to_string(cloud.points.size()) +
                " points where rig.json says " + std::to_string(expected) +
                " with normals, confidence and sigma_mm; run lfm-scan again");
  }
  return cloud;
}

}  // namespace

void SaveScan(const ScanResult& result, const std::filesystem::path& folder) {
  WriteFilesTogether(folder, [&](const std::filesystem::path& together) {
    for (size_t i = 0; i < result.scans.size(); ++i) {
      WritePly(result.scans[i].cloud, together / ScanFileName(i));
    }
    WritePly(result.points, together / "points.ply");
    WriteJson(RigJson(result), together / "rig.json");
  });
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
  result.rig.projector_terms = reader.Integer("projector_terms", 0, 4);
  result.rig.raster_gain = NonNegative(reader, "raster_gain");
  result.rig.source = ReadSource(reader);
  for (JsonReader& t : reader.Objects("turntables")) result.turntables.push_back(ReadTurntable(t));
  result.registration = ReadRegistration(reader.Object("registration"));
  size_t total = 0;
  for (JsonReader& scan : reader.Objects("scans")) {
    const std::string id = scan.Text("id");
    const size_t points = static_cast<size_t>(scan.Integer("points", 0, INT32_MAX));
    JsonReader stands = scan.Object("camera_from_world");
    const Pose camera_from_world = PoseFromJson(stands);
    stands.Finish();
    scan.Finish();
    if (result.scans.size() >= kMaxScans) reader.Fail("scans", "too many");
    result.scans.push_back(
        {id, ReadCloud(folder / ScanFileName(result.scans.size()), points), camera_from_world});
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

std::optional<KnownRig> KnownRigOf(const ScanOptions& options) {
  if (options.rig.empty()) return std::nullopt;
  const nlohmann::json json = ReadJson(options.rig);
  if (!json.is_object()) throw Error(options.rig + ": expected an object with a known rig");
  // What a scan wrote beside its rig says nothing about the rig.
  nlohmann::json rig = nlohmann::json::object();
  for (const char* key : {"camera", "projector", "projector_from_camera"}) {
    if (json.contains(key)) rig[key] = json[key];
  }
  JsonReader reader(rig, options.rig);
  KnownRig known;
  known.camera = ReadKnownCamera(reader.Object("camera"));
  known.projector = ReadKnownCamera(reader.Object("projector"));
  JsonReader pose = reader.Object("projector_from_camera");
  known.projector_from_camera = PoseFromJson(pose);
  pose.Finish();
  reader.Finish();
  known.source = options.rig;
  return known;
}

}  // namespace lfm
