// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera_json.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lfm {
namespace {

struct CameraTerm {
  const char* key;
  double Camera::*value;
};
constexpr CameraTerm kPinhole[] = {
    {"fx", &Camera::fx}, {"fy", &Camera::fy}, {"cx", &Camera::cx}, {"cy", &Camera::cy}};
constexpr CameraTerm kLens[] = {{"k1", &Camera::k1},
                                {"k2", &Camera::k2},
                                {"k3", &Camera::k3},
                                {"p1", &Camera::p1},
                                {"p2", &Camera::p2}};
constexpr CameraTerm kRational[] = {{"k4", &Camera::k4}, {"k5", &Camera::k5}, {"k6", &Camera::k6}};

// In longer sides of the picture. A lens of 600 mm has 17 on 35 mm film, and a crop of its picture
// to a fiftieth 850; 0.01 would see 89 degrees off its axis at the edge of the picture.
constexpr double kLeastFocalLength = 0.01, kMostFocalLength = 1000;
// Of that crop, the principal point may lie 25 outside.
constexpr double kMostOffCentre = 50;

void RequireFocalLength(const JsonReader& reader, const char* key, double focal_px, double side) {
  if (focal_px >= kLeastFocalLength * side && focal_px <= kMostFocalLength * side) return;
  char problem[160];
  std::snprintf(problem, sizeof problem,
                "must be %g to %g px for a picture whose longer side has %g px, not %g",
                kLeastFocalLength * side, kMostFocalLength * side, side, focal_px);
  reader.Fail(key, problem);
}

void RequireNearPicture(const JsonReader& reader, const char* key, double centre_px, double side) {
  if (std::abs(centre_px) <= kMostOffCentre * side) return;
  char problem[160];
  std::snprintf(problem, sizeof problem,
                "must lie within %g px of the first pixel of a picture whose longer side has %g "
                "px, not at %g",
                kMostOffCentre * side, side, centre_px);
  reader.Fail(key, problem);
}

}  // namespace

nlohmann::json IntrinsicsToJson(const Camera& camera) {
  nlohmann::json json = nlohmann::json::object();
  for (const CameraTerm& term : kPinhole) json[term.key] = camera.*term.value;
  for (const CameraTerm& term : kLens) json[term.key] = camera.*term.value;
  if (camera.IsRational()) {
    for (const CameraTerm& term : kRational) json[term.key] = camera.*term.value;
  }
  return json;
}

nlohmann::json CameraToJson(const Camera& camera) {
  nlohmann::json json = IntrinsicsToJson(camera);
  json["width"] = camera.width;
  json["height"] = camera.height;
  return json;
}

Camera IntrinsicsFromJson(JsonReader& reader, int width, int height, LensKeys keys) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  for (const CameraTerm& term : kPinhole) camera.*term.value = reader.Number(term.key);
  for (const CameraTerm& term : kLens) {
    camera.*term.value =
        keys == LensKeys::kRequired ? reader.Number(term.key) : reader.NumberOr(term.key, 0);
  }
  for (const CameraTerm& term : kRational) camera.*term.value = reader.NumberOr(term.key, 0);
  if (camera.fx <= 0) reader.Fail("fx", "must be positive");
  if (camera.fy <= 0) reader.Fail("fy", "must be positive");
  const double side = std::max(width, height);
  RequireFocalLength(reader, "fx", camera.fx, side);
  RequireFocalLength(reader, "fy", camera.fy, side);
  RequireNearPicture(reader, "cx", camera.cx, side);
  RequireNearPicture(reader, "cy", camera.cy, side);
  reader.Finish();
  return camera;
}

Camera CameraFromJson(JsonReader& reader, int max_side, LensKeys keys) {
  const int width = reader.Integer("width", 1, max_side);
  const int height = reader.Integer("height", 1, max_side);
  return IntrinsicsFromJson(reader, width, height, keys);
}

}  // namespace lfm
