// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/photographs.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <utility>

#include "core/capture.h"
#include "core/error.h"
#include "core/image_metrics.h"
#include "core/parallel.h"

namespace lfm {
namespace {

std::string SizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// The pinhole of a lens, `shrink` times as small: whole blocks of pixels only.
Camera PinholeOf(const Camera& lens, int shrink) {
  Camera pinhole = shrink > 1 ? ScaleCamera(lens, 1.0 / shrink) : lens;
  pinhole.width = std::max(1, lens.width / shrink);
  pinhole.height = std::max(1, lens.height / shrink);
  pinhole.k1 = pinhole.k2 = pinhole.k3 = pinhole.k4 = pinhole.k5 = pinhole.k6 = 0;
  pinhole.p1 = pinhole.p2 = 0;
  return pinhole;
}

/// Where the photograph shows what a pinhole of its size has at (x, y).
std::optional<Eigen::Vector2d> PixelInPhotograph(const Camera& lens, int x, int y) {
  std::optional<Eigen::Vector2d> pixel(std::in_place, x, y);
  if (lens.HasDistortion()) {
    pixel = Project(lens, {(x - lens.cx) / lens.fx, (y - lens.cy) / lens.fy, 1});
  }
  return pixel && lens.Contains(*pixel) ? pixel : std::nullopt;
}

/// Mean over a block of the pinhole's pixels, linear; no answer when one of them is not seen.
std::optional<Eigen::Vector3d> BlockMean(const Image& linear, const Camera& lens, int block_x,
                                         int block_y, int side) {
  const int green = linear.channels() >= 3 ? 1 : 0, blue = 2 * green;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = block_y * side; y < (block_y + 1) * side; ++y) {
    for (int x = block_x * side; x < (block_x + 1) * side; ++x) {
      const auto pixel = PixelInPhotograph(lens, x, y);
      if (!pixel) return std::nullopt;
      sum += Eigen::Vector3d(SampleBilinear(linear, pixel->x(), pixel->y(), 0),
                             SampleBilinear(linear, pixel->x(), pixel->y(), green),
                             SampleBilinear(linear, pixel->x(), pixel->y(), blue));
    }
  }
  return sum / (static_cast<double>(side) * side);
}

PinholePicture MakePinholePicture(const Image& photograph, const Camera& lens, int shrink) {
  PinholePicture result;
  result.camera = PinholeOf(lens, shrink);
  const int width = result.camera.width, height = result.camera.height;
  result.seen = Image(width, height, 1, PixelType::kUint8, ColorEncoding::kLinear);
  if (shrink == 1 && !lens.HasDistortion()) {
    result.color = ToRgb8(photograph);
    std::fill_n(result.seen.Data<uint8_t>(), result.seen.size(), uint8_t{255});
    return result;
  }
  const Image linear = ToLinearFloat(photograph);
  Image color(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  ParallelFor(0, height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const auto mean = BlockMean(linear, lens, x, y, shrink);
      if (!mean) continue;
      result.seen.At<uint8_t>(x, y) = 255;
      for (int c = 0; c < 3; ++c) color.At<float>(x, y, c) = static_cast<float>((*mean)[c]);
    }
  });
  result.color = ToSrgb8(color);
  return result;
}

void RequireBytes(const Image& image, int channels, const Image& like, const char* what) {
  if (image.type() != PixelType::kUint8 || image.channels() != channels) {
    throw Error(std::string(what) + " to compare must be 8-bit with " +
                (channels == 1 ? "one channel" : "three channels"));
  }
  if (image.width() != like.width() || image.height() != like.height()) {
    throw Error(std::string(what) + " to compare has " + SizeText(image.width(), image.height()) +
                " pixels, the photograph " + SizeText(like.width(), like.height()));
  }
}

}  // namespace

std::vector<PosedPhotograph> FindPhotographs(const std::filesystem::path& work,
                                             const std::filesystem::path& capture) {
  const std::map<std::string, PosedCamera> cameras = PhotoCameras(work);
  std::vector<PosedPhotograph> photographs;
  for (const Photo& photo : LoadCapture(capture).photos) {
    const auto camera = cameras.find(photo.id);
    if (camera == cameras.end()) continue;
    photographs.push_back({photo.id, photo.file, camera->second, photo.split == PhotoSplit::kTest});
  }
  if (photographs.empty()) {
    throw Error(capture.string() + ": none of its photographs has a pose in " +
                (work / "calib" / "poses.json").string() +
                "; name the capture that the working folder was made from");
  }
  std::sort(photographs.begin(), photographs.end(),
            [](const PosedPhotograph& a, const PosedPhotograph& b) { return a.id < b.id; });
  return photographs;
}

PinholePicture ReadPinholePicture(const PosedPhotograph& photograph,
                                  const std::filesystem::path& capture, int max_side) {
  if (max_side < 1) throw Error("a photograph's longest side must be 1 pixel or more");
  const Image picture = MakeImageLoader(LoadCapture(capture))(photograph.file.string());
  const Camera& lens = photograph.camera.camera;
  if (picture.width() != lens.width || picture.height() != lens.height) {
    throw Error((capture / photograph.file).string() + ": is " +
                SizeText(picture.width(), picture.height()) + " pixels, but its camera has " +
                SizeText(lens.width, lens.height) + "; do not crop or scale photographs");
  }
  // The least f whose whole blocks, longest side / f rounded down, are at most max_side.
  const int64_t shrink = std::max(lens.width, lens.height) / (int64_t{max_side} + 1) + 1;
  return MakePinholePicture(picture, lens, static_cast<int>(shrink));
}

PhotographDifference ComparePhotograph(const PinholePicture& photograph, const Image& rendering,
                                       const Image& coverage, int gain) {
  const Image& color = photograph.color;
  RequireBytes(color, 3, color, "the photograph");
  RequireBytes(photograph.seen, 1, color, "the mask of what a photograph shows");
  RequireBytes(rendering, 3, color, "the rendering");
  RequireBytes(coverage, 1, color, "the coverage of the rendering");
  if (gain < 1) throw Error("the gain of a difference must be 1 or more");
  PhotographDifference result;
  result.picture = Image(color.width(), color.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  int64_t squares = 0, magnitudes = 0;
  for (int y = 0; y < color.height(); ++y) {
    for (int x = 0; x < color.width(); ++x) {
      if (photograph.seen.At<uint8_t>(x, y) != 255 || coverage.At<uint8_t>(x, y) != 255) continue;
      ++result.pixels;
      for (int c = 0; c < 3; ++c) {
        const int64_t difference =
            std::abs(int{rendering.At<uint8_t>(x, y, c)} - color.At<uint8_t>(x, y, c));
        squares += difference * difference;
        magnitudes += difference;
        result.picture.At<uint8_t>(x, y, c) =
            static_cast<uint8_t>(std::min<int64_t>(255, gain * difference));
      }
    }
  }
  if (result.pixels == 0) return result;
  const double values = 3.0 * static_cast<double>(result.pixels);
  result.psnr_db = PsnrFromMse(static_cast<double>(squares) / values);
  result.ape = static_cast<double>(magnitudes) / values;
  return result;
}

}  // namespace lfm
