// SPDX-License-Identifier: BSD-3-Clause
#include "core/capture_reader.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/camera_json.h"

namespace lfm {

std::string PictureIdProblem(const std::string& id) {
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

namespace {

constexpr int kMaxSide = 65536;
constexpr int kMaxCubeResolution = 1024;
// A direction written with six digits is a unit vector within this.
constexpr double kUnitLength_abs = 1e-5;

/// Reads the parts of a manifest; knows the folder that paths must stay in.
class ManifestReader {
 public:
  explicit ManifestReader(const std::filesystem::path& folder) : folder_(folder) {}

  Capture Read(JsonReader& root) const {
    if (root.Text("format") != kCaptureFormat) {
      root.Fail("format", std::string("expected \"") + kCaptureFormat + "\"");
    }
    root.Integer("version", kCaptureVersion, kCaptureVersion);
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
    if (root.Has("reflectance_field")) {
      JsonReader field = root.Object("reflectance_field");
      capture.reflectance_field = ReadReflectanceField(field, capture);
    }
    if (root.Has("transport")) {
      JsonReader transport = root.Object("transport");
      capture.transport = ReadTransport(transport, capture);
    }
    root.Finish();
    return capture;
  }

 private:
  void CheckPath(const JsonReader& reader, const std::string& key, const std::string& file) const {
    const std::string problem = CapturePathProblem(folder_, file);
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

  ColorEncoding Encoding(JsonReader& reader) const {
    const std::string encoding = reader.Text("encoding");
    if (encoding != "linear" && encoding != "srgb") {
      reader.Fail("encoding", "expected \"linear\" or \"srgb\"");
    }
    return encoding == "linear" ? ColorEncoding::kLinear : ColorEncoding::kSrgb;
  }

  PhotoSplit Split(JsonReader& reader) const {
    const std::string split = reader.Text("split");
    if (split != "train" && split != "test") {
      reader.Fail("split", "expected \"train\" or \"test\"");
    }
    return split == "train" ? PhotoSplit::kTrain : PhotoSplit::kTest;
  }

  CaptureCamera ReadCaptureCamera(JsonReader& reader) const {
    CaptureCamera camera;
    camera.width = reader.Integer("width", 1, kMaxSide);
    camera.height = reader.Integer("height", 1, kMaxSide);
    camera.intrinsics = ReadIntrinsics(reader, camera.width, camera.height);
    if (reader.Has("encoding")) camera.encoding = Encoding(reader);
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
    const std::string problem = PictureIdProblem(id);
    if (!problem.empty()) reader.Fail("id", problem);
    if (!ids.insert(id).second) reader.Fail("id", "'" + id + "' is used twice");
    return id;
  }

  Photo ReadPhoto(JsonReader& reader, const Capture& capture, std::set<std::string>& ids) const {
    Photo photo;
    photo.id = UniqueId(reader, ids);
    photo.file = RequiredFile(reader, "file");
    photo.camera = CameraKey(reader, capture);
    photo.split = Split(reader);
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

  Eigen::Vector3d UnitDirection(JsonReader& reader, const std::string& key) const {
    const std::vector<double> numbers = reader.Numbers(key, 3);
    const Eigen::Vector3d direction(numbers[0], numbers[1], numbers[2]);
    if (!(std::abs(direction.norm() - 1) <= kUnitLength_abs)) {
      reader.Fail(key, "must be a unit vector (its length is " + std::to_string(direction.norm()) +
                           "); divide it by its length");
    }
    return direction.normalized();
  }

  std::optional<Eigen::Vector3d> Intensity(JsonReader& reader) const {
    if (!reader.Has("intensity")) return std::nullopt;
    const std::vector<double> rgb = reader.Numbers("intensity", 3);
    const Eigen::Vector3d intensity(rgb[0], rgb[1], rgb[2]);
    if (!(intensity.minCoeff() > 0)) {
      reader.Fail("intensity", "must be positive; leave out the pictures of lights that were off");
    }
    return intensity;
  }

  ReflectanceField ReadReflectanceField(JsonReader& reader, const Capture& capture) const {
    ReflectanceField field;
    field.camera = CameraKey(reader, capture);
    field.camera_from_world = OptionalPose(reader, "camera_from_world");
    field.encoding = Encoding(reader);
    field.mask = OptionalFile(reader, "mask");
    std::set<std::string> files;
    for (JsonReader& picture : reader.Objects("pictures")) {
      LitPicture lit;
      lit.file = RequiredFile(picture, "file");
      if (!files.insert(lit.file).second) picture.Fail("file", "'" + lit.file + "' is used twice");
      lit.to_light = UnitDirection(picture, "direction");
      lit.split = Split(picture);
      lit.intensity = Intensity(picture);
      picture.Finish();
      field.pictures.push_back(std::move(lit));
    }
    if (field.pictures.empty()) {
      reader.Fail("pictures", "is empty; list at least one picture with its light direction");
    }
    reader.Finish();
    return field;
  }

  std::vector<Eigen::Vector3d> Eyes(JsonReader& reader) const {
    std::vector<Eigen::Vector3d> eyes;
    for (const std::vector<double>& row : reader.NumberRows("eyes", 3)) {
      eyes.emplace_back(row[0], row[1], row[2]);
    }
    if (eyes.empty()) reader.Fail("eyes", "is empty; list where the eye of each view stands");
    return eyes;
  }

  TransportField ReadTransport(JsonReader& reader, const Capture& capture) const {
    TransportField transport;
    transport.file = RequiredFile(reader, "file");
    const std::string kind = reader.Text("kind");
    if (kind != "image" && kind != "mesh") reader.Fail("kind", "expected \"image\" or \"mesh\"");
    transport.kind = kind == "image" ? TransportKind::kImage : TransportKind::kMesh;
    transport.cube_resolution = reader.Integer("cube_resolution", 1, kMaxCubeResolution);
    transport.mesh = OptionalFile(reader, "mesh");
    if (transport.kind == TransportKind::kMesh && transport.mesh.empty()) {
      reader.Fail("mesh", "is missing; transport of kind \"mesh\" names the mesh of its rows");
    }
    if (transport.kind == TransportKind::kMesh) {
      transport.eyes = Eyes(reader);
    } else {
      for (const char* key : {"mesh", "eyes"}) {
        if (reader.Has(key)) reader.Fail(key, "belongs to kind \"mesh\" only; leave it out");
      }
      transport.camera = CameraKey(reader, capture);
    }
    reader.Finish();
    return transport;
  }

  std::filesystem::path folder_;
};

}  // namespace

std::string CapturePathProblem(const std::filesystem::path& folder, const std::string& file) {
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

Capture ReadCaptureManifest(JsonReader& root, const std::filesystem::path& folder) {
  return ManifestReader(folder).Read(root);
}

}  // namespace lfm
