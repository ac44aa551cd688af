// SPDX-License-Identifier: BSD-3-Clause
#include "core/capture.h"

#include <algorithm>
#include <set>

#include "core/camera_json.h"
#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr int kMaxSide = 65536;
constexpr int kVersion = 1;
constexpr const char* kFormat = "lfm-capture";
constexpr const char* kManifest = "capture.json";

/// Why `file` may not be named by a manifest in `folder`; empty when it may.
std::string PathProblem(const std::filesystem::path& folder, const std::string& file) {
  if (file.empty()) return "the file name is empty";
  const std::filesystem::path path(file);
  if (path.is_absolute()) return "'" + file + "' is absolute; name files inside the capture folder";
  if (std::find(path.begin(), path.end(), "..") != path.end() ||
      file.find('\0') != std::string::npos) {
    return "'" + file + "' leaves the capture folder";
  }
  std::error_code error;
  const std::filesystem::path root = std::filesystem::weakly_canonical(folder, error);
  if (error) return "the capture folder cannot be resolved (" + error.message() + ")";
  const std::filesystem::path target = std::filesystem::weakly_canonical(root / path, error);
  if (error) return "'" + file + "' cannot be resolved (" + error.message() + ")";
  const auto [root_end, ignored] =
      std::mismatch(root.begin(), root.end(), target.begin(), target.end());
  if (root_end != root.end()) {
    return "'" + file + "' leaves the capture folder through a symbolic link";
  }
  return "";
}

/// Why `id` may not name a picture; empty when it may. Ids become file names.
std::string IdProblem(const std::string& id) {
  constexpr size_t kMaxLength = 64;
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  };
  if (id.empty()) return "is empty";
  if (id.size() > kMaxLength) return "is longer than " + std::to_string(kMaxLength) + " characters";
  if (id.front() == '.' || !std::all_of(id.begin(), id.end(), is_allowed)) {
    return "must be made of letters, digits, '.', '_' and '-', and must not begin with '.'";
  }
  return "";
}

/// Reads the parts of a manifest; knows the folder that paths must stay in.
class ManifestReader {
 public:
  explicit ManifestReader(const std::filesystem::path& folder) : folder_(folder) {}

  Capture Read(JsonReader& root) const {
    if (root.Text("format") != kFormat) {
      root.Fail("format", std::string("expected \"") + kFormat + "\"");
    }
    root.Integer("version", kVersion, kVersion);
    Capture capture;
    capture.folder = folder_;
    capture.name = root.TextOr("name", "");
    capture.board = OptionalFile(root, "board");
    capture.mesh = OptionalFile(root, "mesh");
    JsonReader cameras = root.Object("cameras");
    for (const std::string& key : cameras.Keys()) {
      JsonReader camera = cameras.Object(key);
      capture.cameras[key] = ReadCaptureCamera(camera);
    }
    std::set<std::string> ids;
    for (JsonReader& photo : root.Objects("photos")) {
      capture.photos.push_back(ReadPhoto(photo, capture, ids));
    }
    if (root.Has("scanner")) {
      JsonReader scanner = root.Object("scanner");
      capture.scanner = ReadScanner(scanner, capture, ids);
    }
    root.Finish();
    return capture;
  }

 private:
  void CheckPath(const JsonReader& reader, const std::string& key, const std::string& file) const {
    const std::string problem = PathProblem(folder_, file);
    if (!problem.empty()) reader.Fail(key, problem);
  }

  std::string RequiredFile(JsonReader& reader, const std::string& key) const {
    const std::string file = reader.Text(key);
    CheckPath(reader, key, file);
    return file;
  }

  std::string OptionalFile(JsonReader& reader, const std::string& key) const {
    return reader.Has(key) ? RequiredFile(reader, key) : "";
  }

  std::optional<Camera> ReadIntrinsics(JsonReader& owner, int width, int height) const {
    if (!owner.Has("intrinsics")) return std::nullopt;
    JsonReader reader = owner.Object("intrinsics");
    return IntrinsicsFromJson(reader, width, height, LensKeys::kOptional);
  }

  std::optional<Pose> OptionalPose(JsonReader& owner, const std::string& key) const {
    if (!owner.Has(key)) return std::nullopt;
    JsonReader reader = owner.Object(key);
    const Pose pose = PoseFromJson(reader);
    reader.Finish();
    return pose;
  }

  CaptureCamera ReadCaptureCamera(JsonReader& reader) const {
    CaptureCamera camera;
    camera.width = reader.Integer("width", 1, kMaxSide);
    camera.height = reader.Integer("height", 1, kMaxSide);
    camera.intrinsics = ReadIntrinsics(reader, camera.width, camera.height);
    if (reader.Has("encoding")) {
      const std::string encoding = reader.Text("encoding");
      if (encoding != "linear" && encoding != "srgb") {
        reader.Fail("encoding", "expected \"linear\" or \"srgb\"");
      }
      camera.encoding = encoding == "linear" ? ColorEncoding::kLinear : ColorEncoding::kSrgb;
    }
    reader.Finish();
    return camera;
  }

  std::string CameraKey(JsonReader& reader, const Capture& capture) const {
    const std::string key = reader.Text("camera");
    if (!capture.cameras.contains(key)) reader.Fail("camera", "no camera '" + key + "' is listed");
    return key;
  }

  std::string UniqueId(JsonReader& reader, std::set<std::string>& ids) const {
    const std::string id = reader.Text("id");
    const std::string problem = IdProblem(id);
    if (!problem.empty()) reader.Fail("id", problem);
    if (!ids.insert(id).second) reader.Fail("id", "'" + id + "' is used twice");
    return id;
  }

  Photo ReadPhoto(JsonReader& reader, const Capture& capture, std::set<std::string>& ids) const {
    Photo photo;
    photo.id = UniqueId(reader, ids);
    photo.file = RequiredFile(reader, "file");
    photo.camera = CameraKey(reader, capture);
    const std::string split = reader.Text("split");
    if (split != "train" && split != "test") {
      reader.Fail("split", "expected \"train\" or \"test\"");
    }
    photo.split = split == "train" ? PhotoSplit::kTrain : PhotoSplit::kTest;
    photo.camera_from_world = OptionalPose(reader, "camera_from_world");
    photo.mask = OptionalFile(reader, "mask");
    reader.Finish();
    return photo;
  }

  std::vector<std::string> Roles(JsonReader& reader, const std::string& key) const {
    std::vector<std::string> roles = reader.Texts(key);
    const std::set<std::string> distinct(roles.begin(), roles.end());
    if (distinct.size() != roles.size()) reader.Fail(key, "a role is listed twice");
    if (distinct.contains("")) reader.Fail(key, "a role is empty");
    return roles;
  }

  std::vector<ScanSet> ReadScanSets(JsonReader& scanner, const std::string& key, size_t role_count,
                                    std::set<std::string>& ids) const {
    std::vector<ScanSet> sets;
    for (JsonReader& reader : scanner.Objects(key)) {
      ScanSet set;
      set.id = UniqueId(reader, ids);
      set.frames = reader.Texts("frames");
      if (set.frames.size() != role_count) {
        reader.Fail("frames", std::to_string(set.frames.size()) + " frames for " +
                                  std::to_string(role_count) + " roles");
      }
      for (const std::string& frame : set.frames) CheckPath(reader, "frames", frame);
      set.camera_from_world = OptionalPose(reader, "camera_from_world");
      reader.Finish();
      sets.push_back(std::move(set));
    }
    return sets;
  }

  Scanner ReadScanner(JsonReader& reader, const Capture& capture,
                      std::set<std::string>& ids) const {
    Scanner scanner;
    scanner.camera = CameraKey(reader, capture);
    JsonReader projector = reader.Object("projector");
    scanner.projector_width = projector.Integer("width", 1, kMaxSide);
    scanner.projector_height = projector.Integer("height", 1, kMaxSide);
    scanner.projector =
        ReadIntrinsics(projector, scanner.projector_width, scanner.projector_height);
    projector.Finish();
    scanner.projector_from_camera = OptionalPose(reader, "projector_from_camera");
    scanner.scan_roles = Roles(reader, "scan_roles");
    scanner.placement_roles = Roles(reader, "placement_roles");
    scanner.scans = ReadScanSets(reader, "scans", scanner.scan_roles.size(), ids);
    scanner.placements = ReadScanSets(reader, "placements", scanner.placement_roles.size(), ids);
    reader.Finish();
    return scanner;
  }

  std::filesystem::path folder_;
};

void PutIntrinsics(nlohmann::json& owner, const std::optional<Camera>& camera) {
  if (camera) owner["intrinsics"] = IntrinsicsToJson(*camera);
}

void PutPose(nlohmann::json& owner, const char* key, const std::optional<Pose>& pose) {
  if (pose) owner[key] = PoseToJson(*pose);
}

void PutText(nlohmann::json& owner, const char* key, const std::string& text) {
  if (!text.empty()) owner[key] = text;
}

nlohmann::json CaptureCameraToJson(const CaptureCamera& camera) {
  nlohmann::json json = {{"width", camera.width}, {"height", camera.height}};
  PutIntrinsics(json, camera.intrinsics);
  if (camera.encoding) {
    json["encoding"] = *camera.encoding == ColorEncoding::kLinear ? "linear" : "srgb";
  }
  return json;
}

nlohmann::json PhotoToJson(const Photo& photo) {
  nlohmann::json json = {{"id", photo.id}, {"file", photo.file}, {"camera", photo.camera}};
  json["split"] = photo.split == PhotoSplit::kTrain ? "train" : "test";
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
  return ManifestReader(folder).Read(root);
}

void SaveCapture(const Capture& capture) {
  nlohmann::json json = {{"format", kFormat}, {"version", kVersion}};
  PutText(json, "name", capture.name);
  PutText(json, "board", capture.board);
  PutText(json, "mesh", capture.mesh);
  json["cameras"] = nlohmann::json::object();
  for (const auto& [key, camera] : capture.cameras)
    json["cameras"][key] = CaptureCameraToJson(camera);
  json["photos"] = nlohmann::json::array();
  for (const Photo& photo : capture.photos) json["photos"].push_back(PhotoToJson(photo));
  if (capture.scanner) json["scanner"] = ScannerToJson(*capture.scanner);
  const std::filesystem::path file = capture.folder / kManifest;
  // What would not load again must not be written.
  JsonReader root(json, file.string());
  ManifestReader(capture.folder).Read(root);
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
  return [folder = capture.folder, encodings = std::move(encodings)](const std::string& file) {
    const std::string problem = PathProblem(folder, file);
    if (!problem.empty()) throw Error((folder / kManifest).string() + ": " + problem);
    const auto encoding = encodings.find(file);
    return ReadImage(folder / file, encoding == encodings.end() ? std::nullopt : encoding->second);
  };
}

}  // namespace lfm
