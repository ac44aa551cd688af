// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/camera_path.h"

#include <algorithm>
#include <cmath>

#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kMostFrames = 100000;
constexpr double kMostDegrees = 1e6;
constexpr double kMostMillimetres = 1e9;

// What is interpolated: azimuth (not wrapped), elevation, log of distance, target.
using Place = Eigen::Matrix<double, 6, 1>;

Place PlaceOf(const OrbitCamera& camera) {
  Place place;
  place << camera.azimuth, camera.elevation, std::log(camera.distance), camera.target;
  return place;
}

OrbitCamera CameraAt(const Place& place, const OrbitCamera& like) {
  OrbitCamera camera = like;
  camera.azimuth = place[0];
  camera.elevation = std::clamp(place[1], -OrbitCamera::kMaxElevation, OrbitCamera::kMaxElevation);
  camera.distance = std::exp(place[2]);
  camera.min_distance = std::min(like.min_distance, camera.distance);
  camera.max_distance = std::max(like.max_distance, camera.distance);
  camera.target = place.tail<3>();
  return camera;
}

// Change a second at a key; none at the ends, and none where the direction turns round: between two
// keys nothing runs beyond them (Fritsch and Carlson's condition, by their harmonic mean).
Place SpeedAt(const std::vector<CameraPath::Key>& keys, size_t i) {
  if (i == 0 || i + 1 == keys.size()) return Place::Zero();
  const double before_s = keys[i].time - keys[i - 1].time;
  const double after_s = keys[i + 1].time - keys[i].time;
  const Place before = (PlaceOf(keys[i].camera) - PlaceOf(keys[i - 1].camera)) / before_s;
  const Place after = (PlaceOf(keys[i + 1].camera) - PlaceOf(keys[i].camera)) / after_s;
  const double w1 = 2 * after_s + before_s, w2 = after_s + 2 * before_s;
  Place speed = Place::Zero();
  for (int k = 0; k < speed.size(); ++k) {
    if (before[k] * after[k] > 0) speed[k] = (w1 + w2) / (w1 / before[k] + w2 / after[k]);
  }
  return speed;
}

}  // namespace

CameraPath ReadCameraPath(const std::filesystem::path& file, const OrbitCamera& start) {
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  CameraPath path;
  path.frames_per_second = reader.NumberOr("frames_per_second", 25);
  if (!(path.frames_per_second > 0 && path.frames_per_second <= 1000)) {
    reader.Fail("frames_per_second", "expected a number above 0, up to 1000");
  }
  for (JsonReader& key : reader.Objects("keys")) {
    CameraPath::Key& added = path.keys.emplace_back();
    added.camera = start;
    added.time = key.Number("time");
    if (path.keys.size() > 1 && !(added.time > path.keys[path.keys.size() - 2].time)) {
      key.Fail("time", "expected a later time than the key before");
    }
    const double azimuth = key.Number("azimuth"), elevation = key.Number("elevation");
    if (std::abs(azimuth) > kMostDegrees) key.Fail("azimuth", "expected up to a million degrees");
    if (std::abs(elevation) > 89) key.Fail("elevation", "expected -89 to 89 degrees");
    added.camera.azimuth = azimuth * kDegree;
    added.camera.elevation = elevation * kDegree;
    added.camera.distance = key.NumberOr("distance", start.distance);
    if (!(added.camera.distance > 0 && added.camera.distance <= kMostMillimetres)) {
      key.Fail("distance", "expected millimetres above 0");
    }
    added.camera.min_distance = std::min(start.min_distance, added.camera.distance);
    added.camera.max_distance = std::max(start.max_distance, added.camera.distance);
    if (key.Has("target")) {
      const std::vector<double> target = key.Numbers("target", 3);
      added.camera.target = {target[0], target[1], target[2]};
      if (!(added.camera.target.cwiseAbs().maxCoeff() <= kMostMillimetres)) {
        key.Fail("target", "expected no more than 1e9 mm");
      }
    }
    key.Finish();
  }
  if (path.keys.empty()) reader.Fail("keys", "expected one at least");
  const double seconds = path.keys.back().time - path.keys.front().time;
  if (!(seconds * path.frames_per_second < kMostFrames)) {
    reader.Fail("keys", "expected no more than 100000 frames");
  }
  reader.Finish();
  return path;
}

void WriteCameraPath(const CameraPath& path, const std::filesystem::path& file) {
  nlohmann::json keys = nlohmann::json::array();
  for (const CameraPath::Key& key : path.keys) {
    const Eigen::Vector3d& target = key.camera.target;
    keys.push_back({{"time", key.time},
                    {"azimuth", key.camera.azimuth / kDegree},
                    {"elevation", key.camera.elevation / kDegree},
                    {"distance", key.camera.distance},
                    {"target", {target.x(), target.y(), target.z()}}});
  }
  WriteJson({{"frames_per_second", path.frames_per_second}, {"keys", keys}}, file);
}

std::vector<OrbitCamera> FramesOf(const CameraPath& path) {
  const auto& keys = path.keys;
  const double begin = keys.front().time, end = keys.back().time;
  // A last frame at the last key, though its time be rounded.
  const auto count =
      static_cast<int>(std::floor((end - begin) * path.frames_per_second + 1e-6)) + 1;
  std::vector<OrbitCamera> frames;
  size_t i = 0;
  for (int frame = 0; frame < count; ++frame) {
    const double time = std::min(end, begin + frame / path.frames_per_second);
    while (i + 2 < keys.size() && time >= keys[i + 1].time) ++i;
    if (keys.size() == 1) {
      frames.push_back(keys[0].camera);
      continue;
    }
    // Cubic Hermite between keys i and i + 1.
    const double span = keys[i + 1].time - keys[i].time, s = (time - keys[i].time) / span;
    const double s2 = s * s, s3 = s2 * s;
    const Place place = (2 * s3 - 3 * s2 + 1) * PlaceOf(keys[i].camera) +
                        (s3 - 2 * s2 + s) * span * SpeedAt(keys, i) +
                        (3 * s2 - 2 * s3) * PlaceOf(keys[i + 1].camera) +
                        (s3 - s2) * span * SpeedAt(keys, i + 1);
    frames.push_back(CameraAt(place, keys[i].camera));
  }
  return frames;
}

}  // namespace lfm
