// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera_json.h"

#include <gtest/gtest.h>

#include "test_files.h"

namespace lfm {
namespace {

Camera SomeCamera() {
  Camera camera;
  camera.width = 960, camera.height = 720;
  camera.fx = 4000.0 / 3, camera.fy = 2000.0 / 7, camera.cx = 481.5, camera.cy = -3;
  camera.k1 = -0.1, camera.k2 = 0.02, camera.k3 = 1e-9, camera.p1 = 4e-4, camera.p2 = -2e-4;
  return camera;
}

Camera Parse(const nlohmann::json& json, LensKeys keys) {
  JsonReader reader(json, "file.json");
  return CameraFromJson(reader, 1000, keys);
}

TEST(CameraJson, RoundTripsEveryNumber) {
  const Camera a = SomeCamera();
  // As a file has it: text.
  const Camera b = Parse(nlohmann::json::parse(CameraToJson(a).dump()), LensKeys::kRequired);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  for (double Camera::*term : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1,
                               &Camera::k2, &Camera::k3, &Camera::p1, &Camera::p2}) {
    EXPECT_EQ(a.*term, b.*term);
  }
}

TEST(CameraJson, RationalTermsAreWrittenWhereThereAreAny) {
  EXPECT_FALSE(CameraToJson(SomeCamera()).contains("k4"));
  Camera camera = SomeCamera();
  camera.k5 = 0.3;
  const Camera read = Parse(CameraToJson(camera), LensKeys::kRequired);
  EXPECT_EQ(read.k4, 0);
  EXPECT_EQ(read.k5, 0.3);
  EXPECT_EQ(read.k6, 0);
}

TEST(CameraJson, LensTermsMayBeLeftOutWhereAFileSaysSo) {
  nlohmann::json json = CameraToJson(SomeCamera());
  json.erase("k3");
  EXPECT_EQ(Parse(json, LensKeys::kOptional).k3, 0);
  EXPECT_EQ(Parse(json, LensKeys::kOptional).k2, 0.02);
  ExpectError([&] { Parse(json, LensKeys::kRequired); }, "k3");
}

TEST(CameraJson, RefusesWhatIsNoCamera) {
  const auto refuses = [](const char* key, const nlohmann::json& value) {
    nlohmann::json json = CameraToJson(SomeCamera());
    json[key] = value;
    ExpectError([&] { Parse(json, LensKeys::kRequired); }, key);
  };
  refuses("width", 0);
  refuses("height", 1001);
  refuses("fx", 0);
  refuses("fy", -1);
  refuses("cx", nullptr);
  refuses("k4", nullptr);
  refuses("k7", 1);
}

TEST(CameraJson, RefusesWhatNoLensHasAndAcceptsLongAndShiftedOnes) {
  const auto parse = [](const char* key, double value) {
    nlohmann::json json = CameraToJson(SomeCamera());
    json[key] = value;
    Parse(json, LensKeys::kRequired);
  };
  for (const char* key : {"fx", "fy"}) {
    EXPECT_NO_THROW(parse(key, 20 * 960));
    for (const double value : {1e300, 1e7, 0.1}) ExpectError([&] { parse(key, value); }, key);
  }
  for (const char* key : {"cx", "cy"}) {
    EXPECT_NO_THROW(parse(key, -3 * 960));
    for (const double value : {1e10, -1e300}) {
      ExpectError([&] { parse(key, value); }, std::string("file.json: ") + key);
    }
  }
}

}  // namespace
}  // namespace lfm
