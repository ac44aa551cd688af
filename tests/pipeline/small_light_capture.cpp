// SPDX-License-Identifier: BSD-3-Clause
#include "tests/pipeline/small_light_capture.h"

#include <cmath>
#include <sstream>

#include "core/atomic_file.h"
#include "core/capture.h"
#include "core/image.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

constexpr int kWidth = 12, kHeight = 9;

Eigen::Vector3d DomeDirection(int i, int count) {
  const double z = 1 - (i + 0.5) / count, r = std::sqrt(1 - z * z);
  return {r * std::cos(2.4 * i), r * std::sin(2.4 * i), z};
}

Image Shade(const Eigen::Vector3d& to_light) {
  Image picture(kWidth, kHeight, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  const float color[3] = {0.8f, 0.6f, 0.3f};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 1; x < kWidth; ++x) {  // the first column is background
      const Eigen::Vector3d normal =
          Eigen::Vector3d(0.12 * (x - 6), 0.12 * (4 - y), 1).normalized();
      const bool shadow = x > 8 && to_light.x() < -0.4;
      const double shading = shadow ? 0 : std::max(0.0, normal.dot(to_light));
      for (int c = 0; c < 3; ++c) {
        picture.At<float>(x, y, c) = color[c] * static_cast<float>(shading);
      }
    }
  }
  return ToSrgb8(picture);
}

std::string PictureName(int i) { return "light_" + std::to_string(i) + ".png"; }

}  // namespace

void WriteSmallLightCapture(const fs::path& folder, int lights, HeldOutLights held_out) {
  Capture capture;
  capture.folder = folder;
  capture.name = "bump";
  capture.cameras["view"] = {kWidth, kHeight, std::nullopt};
  ReflectanceField field;
  field.camera = "view";
  for (int i = 0; i < lights; ++i) {
    const bool test = held_out == HeldOutLights::kEveryFourth && i % 4 == 1;
    LitPicture picture;
    picture.file = PictureName(i);
    picture.to_light = DomeDirection(i, lights);
    picture.split = test ? PhotoSplit::kTest : PhotoSplit::kTrain;
    field.pictures.push_back(picture);
    WriteImage(Shade(picture.to_light), folder / picture.file);
  }
  capture.reflectance_field = field;
  SaveCapture(capture);
}

void WriteSmallLpCapture(const fs::path& folder, int lights) {
  std::ostringstream lp;
  lp << lights << "\r\n";
  for (int i = 0; i < lights; ++i) {
    const Eigen::Vector3d to_light = DomeDirection(i, lights);
    WriteImage(Shade(to_light), folder / PictureName(i));
    lp << PictureName(i) << " " << to_light.x() << " " << to_light.y() << " " << to_light.z()
       << "\r\n";
  }
  WriteFileAtomically(folder / "dome.lp", lp.str());
}

}  // namespace lfm
