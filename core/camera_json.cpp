// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera_json.h"

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
  reader.Finish();
  return camera;
}

Camera CameraFromJson(JsonReader& reader, int max_side, LensKeys keys) {
  const int width = reader.Integer("width", 1, max_side);
  const int height = reader.Integer("height", 1, max_side);
  return IntrinsicsFromJson(reader, width, height, keys);
}

}  // namespace lfm
